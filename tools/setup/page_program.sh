#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The first program of a page, in a language: usage: tools/setup/page_program.sh docs/c.md c
set -euo pipefail
exec awk -v begin="\`\`\`$2" '$0 == begin && !seen { inside = seen = 1; next } $0 == "```" { inside = 0 } inside' "$1"
