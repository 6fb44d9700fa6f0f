"""One simulated device alone, on real sockets, for foreign software."""

from cell.standalone.abb import AbbOptions, run_abb

__all__ = ["AbbOptions", "run_abb"]
