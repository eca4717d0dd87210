"""Entry point of `python -m neuralgaits`: runs the command line."""

from neuralgaits.cli.main import run

if __name__ == "__main__":
    run()
