MODULE BpProbeLanguage
  LOCAL VAR num calls;
  LOCAL VAR intnum queued;
  LOCAL VAR num served;

  PROC bpLanguage()
    VAR bool answer;
    VAR num count;
    answer := NOT TRUE AND FALSE;
    bpNoteBool "not-takes-in-and", answer;
    answer := FALSE AND called();
    bpNoteNum "and-calls-right-side", calls;
    calls := 0;
    answer := TRUE OR called();
    bpNoteNum "or-calls-right-side", calls;
    FOR i FROM 3 TO 1 DO
      Incr count;
    ENDFOR
    bpNoteNum "for-counts-down-by-itself", count;
    bpNoteNum "div-of-negative", -7 DIV 2;
    bpNoteNum "mod-of-negative", -7 MOD 2;
    bpInterrupts;
  ENDPROC

  LOCAL FUNC bool called()
    Incr calls;
    RETURN TRUE;
  ENDFUNC

  LOCAL PROC bpInterrupts()
    CONNECT queued WITH serve;
    ITimer\Single, 0.1, queued;
    IDisable;
    WaitTime 0.3;
    bpNoteNum "traps-while-idisable", served;
    IEnable;
    WaitTime 0.1;
    bpNoteNum "traps-after-ienable", served;
    CONNECT queued WITH serve;
    bpNote "second-connect", "no error";
    IDelete queued;
  ERROR
    bpNote "second-connect", bpError(ERRNO);
    IDelete queued;
    RETURN;
  ENDPROC

  LOCAL TRAP serve
    Incr served;
  ENDTRAP
ENDMODULE
