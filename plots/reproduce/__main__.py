"""``python -m reproduce`` makes the paper's figures and the pages on its claims and engines."""

import sys

from rwmf.errors import RwmfError

from reproduce.command import main

if __name__ == "__main__":
    try:
        sys.exit(main())
    except RwmfError as error:
        print(f"reproduce: {error}", file=sys.stderr)
        sys.exit(error.exit_status)
