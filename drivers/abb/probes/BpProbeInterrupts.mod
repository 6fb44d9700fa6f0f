MODULE BpProbeInterrupts
  ! What binpick's own modules lean on.
  LOCAL VAR intnum tick;
  LOCAL VAR num traps := 0;
  LOCAL VAR bool mayRaise := FALSE;
  LOCAL VAR errnum ERR_BP_PROBE := -1;
  LOCAL PERS num bpProbeFlag := 0;
  LOCAL VAR socketdev probeListener;
  LOCAL VAR socketdev probeClient;

  PROC bpTraps()
    BookErrNo ERR_BP_PROBE;
    bpTrapInWait;
    bpTrapInAccept;
    bpRaiseFromTrap;
    bpCountedPers;
  ENDPROC

  LOCAL TRAP counting
    traps := traps + 1;
    IF mayRaise RAISE ERR_BP_PROBE;
  ERROR
    RAISE;
  ENDTRAP

  LOCAL PROC bpTrapInWait()
    VAR num before;
    CONNECT tick WITH counting;
    ITimer 0.1, tick;
    before := traps;
    WaitTime 0.35;
    IDelete tick;
    bpNoteNum "traps-during-waittime", traps - before;
  ENDPROC

  ! Needs the sockets' option; without it the answer says so.
  LOCAL PROC bpTrapInAccept()
    VAR num before;
    SocketCreate probeListener;
    SocketBind probeListener, "127.0.0.1", 5019;
    SocketListen probeListener;
    CONNECT tick WITH counting;
    ITimer 0.1, tick;
    before := traps;
    SocketAccept probeListener, probeClient \Time:=0.35;
    bpNote "traps-during-socketaccept", "somebody connected";
  ERROR
    IDelete tick;
    IF ERRNO = ERR_SOCK_TIMEOUT THEN
      bpNoteNum "traps-during-socketaccept", traps - before;
    ELSE
      bpNote "traps-during-socketaccept", bpError(ERRNO);
    ENDIF
    SocketClose probeListener;
    RETURN;
  ENDPROC

  LOCAL PROC bpRaiseFromTrap()
    mayRaise := TRUE;
    CONNECT tick WITH counting;
    ITimer \Single, 0.1, tick;
    WaitTime 0.5;
    mayRaise := FALSE;
    bpNote "raise-from-trap", "the routine went on";
  ERROR
    mayRaise := FALSE;
    IDelete tick;
    IF ERRNO = ERR_BP_PROBE THEN
      bpNote "raise-from-trap", "the interrupted routine's handler";
    ELSE
      bpNote "raise-from-trap", bpError(ERRNO);
    ENDIF
    RETURN;
  ENDPROC

  ! Three changes while interrupts are disabled: how many traps afterwards?
  LOCAL PROC bpCountedPers()
    VAR num before;
    CONNECT tick WITH counting;
    IPers bpProbeFlag, tick;
    before := traps;
    IDisable;
    bpProbeFlag := bpProbeFlag + 1;
    bpProbeFlag := bpProbeFlag + 1;
    bpProbeFlag := bpProbeFlag + 1;
    IEnable;
    WaitTime 0.05;
    IDelete tick;
    bpNoteNum "traps-of-three-changes", traps - before;
  ENDPROC
ENDMODULE
