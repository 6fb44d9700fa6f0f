"""``python -m cell`` is ``binpick``."""

from cell.cli import main

if __name__ == "__main__":
    main()
