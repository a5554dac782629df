"""Makes files with real programs, reads them with splitsum, and compares the numbers.

    python check.py PROGRAM FOLDER [NODE_PACKAGES]

Prints a line a case: `ok NAME: expected; got`, `FAILED` or `skipped`. Exits with 1 after a failure.
"""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import browser
import environments
import scenes
import written
from cases import Reader, Skipped, Wrong


def line(reader, case):
    try:
        expected, got = reader.judge(case)
    except Skipped as why:
        return f"skipped {case.name}: {why}"
    except Wrong as wrong:
        return f"FAILED {case.name}: {wrong}"
    except Exception as error:  # A program that fails to write is a failed case, not the end.
        return f"FAILED {case.name}: {type(error).__name__}: {error}"
    return f"ok {case.name}: {expected}; got {got}"


def main():
    reader = Reader(Path(sys.argv[1]).resolve())
    packages = Path(sys.argv[3]).resolve() if len(sys.argv) > 3 else None
    os.chdir(sys.argv[2])
    environments.sources()
    written.write(reader)
    cases = [*environments.cases(reader), *written.cases(reader), *scenes.cases(reader), *browser.cases(reader, packages)]
    with ThreadPoolExecutor() as pool:
        lines = list(pool.map(lambda case: line(reader, case), cases))
    print("\n".join(lines))
    counts = {word: sum(text.startswith(word) for text in lines) for word in ["ok", "FAILED", "skipped"]}
    print(", ".join(f"{count} {word}" for word, count in counts.items()))
    sys.exit(counts["FAILED"] > 0)


if __name__ == "__main__":
    main()
