MODULE BpProbeErrors
  LOCAL VAR num zero;

  PROC bpErrors()
    bpInHandler;
    bpMissing;
    bpNoteNum "number-err-divzero", ERR_DIVZERO;
    bpNoteNum "number-err-sock-closed", ERR_SOCK_CLOSED;
    bpNoteNum "number-err-sock-timeout", ERR_SOCK_TIMEOUT;
    bpNoteNum "number-err-strtoolng", ERR_STRTOOLNG;
    bpNoteNum "number-err-wait-maxtime", ERR_WAIT_MAXTIME;
    bpNoteNum "number-err-refunkprc", ERR_REFUNKPRC;
  ERROR
    bpNote "error-in-handler", "goes to the caller";
    TRYNEXT;
  ENDPROC

  LOCAL PROC bpInHandler()
    VAR num n;
    n := 1 / zero;
  ERROR
    n := 1 / zero;
    RETURN;
  ENDPROC

  LOCAL PROC bpMissing()
    %"bpNotThere"%;
    bpNote "missing-procedure", "no error";
  ERROR
    bpNote "missing-procedure", bpError(ERRNO);
    RETURN;
  ENDPROC
ENDMODULE
