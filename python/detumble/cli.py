"""Entry point of the command line. It imports almost nothing, so that Ctrl-C during the imports ends without a traceback."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line. Exit codes: 0 done, 1 the run failed, 2 the request is wrong, 128 + n by signal n."""
    try:
        from detumble.shell import run
    except KeyboardInterrupt:
        sys.exit(130)
    run()


if __name__ == "__main__":
    main()
