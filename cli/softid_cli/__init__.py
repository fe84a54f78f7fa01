"""The command line of softid: parse, load, one library call, write."""
