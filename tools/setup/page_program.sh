#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Prints a program in a language from a page, the first one or the one with the given number.
# usage: tools/setup/page_program.sh docs/user/c.md c [5]
set -euo pipefail
exec awk -v begin="\`\`\`$2" -v number="${3:-1}" \
  '$0 == begin && ++seen == number { inside = 1; next } $0 == "```" { inside = 0 } inside' "$1"
