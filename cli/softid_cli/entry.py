"""Where the installed script starts: Ctrl-C ends the program in one sentence, at any moment.

Nothing is imported on the way here but what the interpreter holds already, so that an interruption
of the imports is caught like any later one.
"""

import os
import sys

INTERRUPTED = 130

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
"""Candidates and starts share the cores already. Threads of the linear algebra, which has small
matrices here, would wait for each other: a fit took ten times as long on a busy machine."""


def main() -> None:
    """Run `softid` with the arguments of the process, and exit."""
    try:
        from softid_cli.main import main as run_and_exit
    except KeyboardInterrupt:
        sys.stderr.write("softid: interrupted.\n")
        sys.stderr.flush()
        os._exit(INTERRUPTED)
    run_and_exit()


if __name__ == "__main__":
    main()
