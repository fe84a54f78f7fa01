"""`python -m softid_cli` is `softid`."""

from softid_cli.entry import main

main()
