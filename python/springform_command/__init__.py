"""The command `springform`, which ends without a word if it is interrupted while it loads.

A package of its own, since importing any part of `springform` loads all of it.
"""

import signal


def main() -> None:
    """Load the command line and run it."""
    handler = signal.getsignal(signal.SIGINT)
    if handler is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from springform.cli import main as run  # noqa: PLC0415

    signal.signal(signal.SIGINT, handler)
    run()
