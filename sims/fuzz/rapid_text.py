"""Any text is RAPID with located errors, or RAPID: never a crash, never a long wait."""

import time
from collections.abc import Sequence

from drivers.abb import package_files
from sims.rapid.parser import parse_text

__all__ = ["RapidText"]

LONGEST_S = 2.0
MAX_BYTES = 4096
WORDS = """MODULE ENDMODULE PROC ENDPROC FUNC ENDFUNC TRAP ENDTRAP RECORD ENDRECORD IF THEN ELSE
ELSEIF ENDIF FOR FROM TO STEP DO ENDFOR WHILE ENDWHILE TEST CASE DEFAULT ENDTEST ERROR UNDO BACKWARD
CONNECT WITH GOTO RETURN RAISE RETRY TRYNEXT EXIT VAR PERS CONST LOCAL TASK INOUT ALIAS NOT AND OR
XOR DIV MOD TRUE FALSE num robtarget := ; : , . { } [ ] ( ) \\ \\switch | ? % %% %%% "a" "" "\\0A"
.5 1E9 1E999 <SMT> <EXP> ! * + - / = <> < <= > >= main a b"""


class RapidText:
    """Seeds are the modules we ship, cut into routines."""

    name = "rapid-text"
    prefixes: tuple[str, ...] = ()
    modules: Sequence[str] = (
        "sims.rapid.lexer",
        "sims.rapid.parser.cursor",
        "sims.rapid.parser.declarations",
        "sims.rapid.parser.expressions",
        "sims.rapid.parser.modules",
        "sims.rapid.parser.statements",
    )

    def seeds(self) -> list[bytes]:
        """Good modules of a few lines."""
        files = {path for paths in package_files().values() for path in paths}
        texts = [path.read_text(encoding="latin-1") for path in sorted(files)]
        routines = [part for text in texts for part in text.split("\n\n") if len(part) < MAX_BYTES]
        return [f"MODULE m\n{part}\nENDMODULE\n".encode("latin-1") for part in routines]

    def pieces(self) -> list[bytes]:
        """Words of the language, with and without a blank."""
        return [
            piece.encode("latin-1") + end for piece in WORDS.split() for end in (b"", b" ", b"\n")
        ]

    def run(self, data: bytes) -> None:
        """Parse; every complaint must stand within the text."""
        text = data[:MAX_BYTES].decode("latin-1")
        began = time.perf_counter()
        modules, diagnostics = parse_text(text, "fuzz.mod")
        took_s = time.perf_counter() - began
        if took_s > LONGEST_S:
            raise AssertionError(f"{len(text)} characters took {took_s:.1f} s")
        lines = text.count("\n") + text.count("\r") + 1
        for diagnostic in diagnostics:
            if not 1 <= diagnostic.at.line <= lines + 1 or diagnostic.at.column < 1:
                raise AssertionError(f"there is no {diagnostic.at}")
        if not modules and not diagnostics and text.strip():
            raise AssertionError("neither a module nor a complaint")
