MODULE BpProbeData
  PROC bpData()
    VAR clock timer;
    VAR num first;
    VAR num tick;
    bpNote "v100", ValToStr(v100);
    bpNote "v7000", ValToStr(v7000);
    bpNote "vmax", ValToStr(vmax);
    bpNote "fine", ValToStr(fine);
    bpNote "z0", ValToStr(z0);
    bpNote "z10", ValToStr(z10);
    bpNote "load0", ValToStr(load0);
    bpNoteNum "socket-created", SOCKET_CREATED;
    bpNoteNum "socket-connected", SOCKET_CONNECTED;
    bpNoteNum "socket-closed", SOCKET_CLOSED;
    bpNoteNum "op-auto", OP_AUTO;
    bpNoteNum "type-udint", UDINT;
    ClkStart timer;
    WHILE tick = 0 DO
      tick := ClkRead(timer) - first;
    ENDWHILE
    bpNoteNum "clock-tick", Round(tick\Dec:=4);
  ENDPROC
ENDMODULE
