# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy on the sources of core and hal, two at a time, with the flags of this build. Skipped without clang-tidy.
A source is checked again only if it, a header of plvo or the rules have changed since it last passed."""
import concurrent.futures
import hashlib
import pathlib
import shutil
import subprocess
import sys

import sources

SKIP = 77


def main():
    root, build = pathlib.Path(sys.argv[1]), sys.argv[2]
    tool = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")
    if not tool:
        print("SKIPPED: clang-tidy is not installed (apt-get install clang-tidy)")
        return SKIP

    common = hashlib.sha256((root / ".clang-tidy").read_bytes())
    for header in sources.files(root, ("core", "hal"), (".hpp",)):
        common.update(header.read_bytes())
    good = pathlib.Path(build) / "tidy"
    good.mkdir(exist_ok=True)

    def run(path):
        key = common.copy()
        key.update(path.read_bytes())
        stamp = good / key.hexdigest()
        if stamp.exists():
            return None
        result = subprocess.run([tool, "--quiet", "-p", build, str(path)], capture_output=True, text=True)
        if result.returncode == 0:
            stamp.touch()
        return result

    files = list(sources.files(root, ("core", "hal"), (".cpp",)))
    with concurrent.futures.ThreadPoolExecutor(max_workers=2) as pool:
        results = [result for result in pool.map(run, files) if result]
    for result in results:
        if result.returncode != 0:
            print(result.stdout, result.stderr, sep="\n")
    bad = sum(result.returncode != 0 for result in results)
    print(f"{len(files)} files, {len(results)} of them read anew, {bad} with something to mend")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
