MODULE BinpickSignals
    ! The cell's signals, and how they are told, written and waited for.

    CONST num BP_WAITS := 4;

    VAR num wSeq{BP_WAITS};
    VAR num wBit{BP_WAITS};
    VAR bool wIsOutput{BP_WAITS};
    VAR num wValue{BP_WAITS};
    VAR num wDue{BP_WAITS};

    ! These four are where the cell's signals stand.
    FUNC num BpInputs()
        RETURN di1 + 2 * di2 + 4 * di3 + 8 * di4 + 16 * di5 + 32 * di6 + 64 * di7 + 128 * di8;
    ENDFUNC

    FUNC num BpOutputs()
        RETURN do1 + 2 * do2 + 4 * do3 + 8 * do4 + 16 * do5 + 32 * do6 + 64 * do7 + 128 * do8;
    ENDFUNC

    PROC BpWrite(num which, num value)
        TEST which
        CASE 1:
            SetDO do1, value;
        CASE 2:
            SetDO do2, value;
        CASE 3:
            SetDO do3, value;
        CASE 4:
            SetDO do4, value;
        CASE 5:
            SetDO do5, value;
        CASE 6:
            SetDO do6, value;
        CASE 7:
            SetDO do7, value;
        CASE 8:
            SetDO do8, value;
        ENDTEST
    ENDPROC

    PROC BpPulse(num which, num length)
        TEST which
        CASE 1:
            PulseDO \High \PLength:=length, do1;
        CASE 2:
            PulseDO \High \PLength:=length, do2;
        CASE 3:
            PulseDO \High \PLength:=length, do3;
        CASE 4:
            PulseDO \High \PLength:=length, do4;
        CASE 5:
            PulseDO \High \PLength:=length, do5;
        CASE 6:
            PulseDO \High \PLength:=length, do6;
        CASE 7:
            PulseDO \High \PLength:=length, do7;
        CASE 8:
            PulseDO \High \PLength:=length, do8;
        ENDTEST
    ENDPROC

    ! Serving ----------------------------------------------------------------------------------

    PROC BpSendSignals(num seq)
        BpBegin bpMonitorData, BP_SIGNALS, seq;
        BpAdd bpMonitorData, Dim(BP_INPUTS, 1) \Byte;
        BpAdd bpMonitorData, Dim(BP_OUTPUTS, 1) \Byte;
        FOR i FROM 1 TO Dim(BP_INPUTS, 1) DO
            BpAddText bpMonitorData, BP_INPUTS{i};
        ENDFOR
        FOR i FROM 1 TO Dim(BP_OUTPUTS, 1) DO
            BpAddText bpMonitorData, BP_OUTPUTS{i};
        ENDFOR
        BpSend bpMonitorClient, bpMonitorData;
    ENDPROC

    ! Which output, value 0 or 1.
    PROC BpDoWrite(num seq)
        VAR num which;
        VAR num value;

        IF RawBytesLen(bpMonitorData) <> 2 THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_BAD_LENGTH, 0;
            RETURN;
        ENDIF
        which := BpByte(bpMonitorData, 1);
        value := BpByte(bpMonitorData, 2);
        IF which < 1 OR which > Dim(BP_OUTPUTS, 1) OR value > 1 THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_NO_SIGNAL, 0;
            RETURN;
        ENDIF
        BpWrite which, value;
        BpAccept bpMonitorClient, bpMonitorData, seq, 0;
    ENDPROC

    ! Which output, length (s).
    PROC BpDoPulse(num seq)
        VAR num which;
        VAR num length;

        IF RawBytesLen(bpMonitorData) <> 5 THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_BAD_LENGTH, 0;
            RETURN;
        ENDIF
        which := BpByte(bpMonitorData, 1);
        length := BpFloat(bpMonitorData, 2);
        IF which < 1 OR which > Dim(BP_OUTPUTS, 1) THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_NO_SIGNAL, 0;
        ELSEIF NOT (length >= 0.001 AND length <= 2000) THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_BAD_ARGUMENT, 0;
        ELSE
            BpPulse which, length;
            BpAccept bpMonitorClient, bpMonitorData, seq, 0;
        ENDIF
    ENDPROC

    ! Is it an output, which, value, at most how long (s). Answered when it is so.
    PROC BpBeginWait(num seq)
        VAR num at := 0;
        VAR num which;
        VAR num count;

        IF RawBytesLen(bpMonitorData) <> 7 THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_BAD_LENGTH, 0;
            RETURN;
        ENDIF
        FOR i FROM 1 TO BP_WAITS DO
            IF wSeq{i} = 0 at := i;
        ENDFOR
        which := BpByte(bpMonitorData, 2);
        count := Dim(BP_INPUTS, 1);
        IF BpByte(bpMonitorData, 1) = 1 count := Dim(BP_OUTPUTS, 1);
        IF at = 0 THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_QUEUE_FULL, 0;
        ELSEIF which < 1 OR which > count OR NOT BpIsNumber(BpFloat(bpMonitorData, 4)) THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_NO_SIGNAL, 0;
        ELSE
            wSeq{at} := seq;
            wIsOutput{at} := BpByte(bpMonitorData, 1) = 1;
            wBit{at} := Pow(2, which - 1);
            wValue{at} := BpByte(bpMonitorData, 3);
            wDue{at} := bpNow + BpFloat(bpMonitorData, 4);
            BpLookAtWait at;
        ENDIF
    ENDPROC

    PROC BpLookAtWait(num at)
        VAR num bits;

        IF wIsOutput{at} THEN
            bits := BpOutputs();
        ELSE
            bits := BpInputs();
        ENDIF
        IF (bits DIV wBit{at}) MOD 2 = wValue{at} THEN
            BpAccept bpMonitorClient, bpMonitorData, wSeq{at}, 0;
            wSeq{at} := 0;
        ELSEIF bpNow > wDue{at} THEN
            BpRefuse bpMonitorClient, bpMonitorData, wSeq{at}, BP_TIMED_OUT, 0;
            wSeq{at} := 0;
        ENDIF
    ENDPROC
ENDMODULE
