"""`python -m neuralgaits`."""

from neuralgaits.cli.main import run

if __name__ == "__main__":
    run()
