"""``python -m gpcourse``."""

from gpcourse.cli import main

main(prog_name="gpcourse")
