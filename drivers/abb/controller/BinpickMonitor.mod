MODULE BinpickMonitor
    ! The monitor task: runs on when the program is stopped. It tells the state, stops the arm,
    ! serves the signals, and watches the client, the stops and the motion task.
    ! A path that was stopped is held until the motion task has cleared it.

    ! Demand again what the motion task has not obeyed (s).
    CONST num BP_REMIND := 0.2;
    ! Time is kept in turns, so that a num stays exact (s).
    CONST num BP_TURN := 64;

    VAR socketdev bpMonitorListener;
    VAR socketdev bpMonitorClient;
    VAR rawbytes bpMonitorData;
    VAR intnum bpExecutionLost;
    VAR intnum bpMotorsLost;
    VAR intnum bpRunchainLost;
    VAR intnum bpEmergency;
    VAR intnum bpWatchdogDue;
    VAR bool bpIsHeld := FALSE;
    VAR num bpStopSeq := 0;         ! a stop that waits for its answer; 0: none

    VAR clock bpClock;
    VAR num bpTurns := 0;
    VAR num bpBase := 0;
    VAR num bpNow := 0;
    VAR num bpHeard := 0;
    VAR num bpStateDue := 0;
    VAR num bpRemindDue := 0;

    PROC main()
        bpHasMonitor := FALSE;
        ClkReset bpClock;
        ClkStart bpClock;
        BpDropMonitor BP_CLIENT_GONE;
        BpConnect;
        WHILE TRUE DO
            BpAwaitMonitor;
            IF bpHasMonitor THEN
                BpDropMonitor BpServeMonitor();
            ENDIF
        ENDWHILE
    ENDPROC

    ! Interrupts see what would else be seen at the next look around: a stop that is over before,
    ! or one that comes while a frame is slow to arrive or nobody takes what is sent.
    PROC BpConnect()
        IDelete bpExecutionLost;
        CONNECT bpExecutionLost WITH BpLostTrap;
        ISignalDO doBpExecuting, 0, bpExecutionLost;
        IDelete bpMotorsLost;
        CONNECT bpMotorsLost WITH BpLostTrap;
        ISignalDO doBpMotorOn, 0, bpMotorsLost;
        IDelete bpRunchainLost;
        CONNECT bpRunchainLost WITH BpLostTrap;
        ISignalDO doBpRunchainOk, 0, bpRunchainLost;
        IDelete bpEmergency;
        CONNECT bpEmergency WITH BpLostTrap;
        ISignalDO doBpEmStop, 1, bpEmergency;
        IDelete bpWatchdogDue;
        CONNECT bpWatchdogDue WITH BpWatchdogTrap;
        ITimer BP_WATCHDOG / 4, bpWatchdogDue;
    ENDPROC

    TRAP BpLostTrap
        VAR num reason;

        reason := BpForbidden();
        IF reason = 0 reason := BP_PROGRAM_STOPPED;
        BpHoldPath reason;
    ENDTRAP

    ! The second look at the client: for when the first one waits in a socket.
    TRAP BpWatchdogTrap
        IF bpHasMonitor AND bpBase + ClkRead(bpClock \HighRes) - bpHeard > 1.5 * BP_WATCHDOG THEN
            BpHoldPath BP_CLIENT_SILENT;
            SocketClose bpMonitorClient;
        ENDIF
    ERROR
        TRYNEXT;
    ENDTRAP

    ! Connections ------------------------------------------------------------------------------

    PROC BpAwaitMonitor()
        VAR string peer;
        VAR num seen := -1;

        WHILE seen <= 0 DO
            IF seen < 0 BpListenAgain;
            seen := BpComes(peer);
            BpReadClock;
            BpWatch;
        ENDWHILE
        SocketClose bpMonitorListener;
        IF BpMayConnect(peer) THEN
            bpEpoch := bpEpoch + 1;
            IF bpEpoch > BP_MAX_COUNT bpEpoch := 1;
            bpHeard := bpNow;
            bpHasMonitor := TRUE;
        ELSE
            TPWrite "binpick: refused " + peer;
            SocketClose bpMonitorClient;
        ENDIF
    ENDPROC

    PROC BpListenAgain()
        WHILE NOT BpListen(bpMonitorListener, BP_MONITOR_PORT) DO
            BpReadClock;
            BpWatch;
            WaitTime 0.1;
        ENDWHILE
    ENDPROC

    ! 1: a client; 0: nobody yet; -1: the listener is broken.
    FUNC num BpComes(INOUT string peer)
        SocketAccept bpMonitorListener, bpMonitorClient \ClientAddress:=peer \Time:=0.05;
        RETURN 1;
    ERROR
        IF ERRNO = ERR_SOCK_TIMEOUT RETURN 0;
        RETURN -1;
    ENDFUNC

    ! The client is lost: so is the right to move.
    PROC BpDropMonitor(num reason)
        bpHasMonitor := FALSE;
        SocketClose bpMonitorClient;
        SocketClose bpMonitorListener;
        FOR i FROM 1 TO BP_WAITS DO
            wSeq{i} := 0;
        ENDFOR
        bpStopSeq := 0;
        BpHoldPath reason;
    ENDPROC

    ! Serves until the client goes; returns the reason.
    FUNC num BpServeMonitor()
        VAR num kind;
        VAR num seq;
        VAR num wrong;
        VAR bool isGreeted := FALSE;

        BpReadClock;
        bpHeard := bpNow;
        bpStateDue := bpNow;
        WHILE TRUE DO
            kind := -1;
            wrong := 0;
            wrong := BpReceive(bpMonitorClient, bpMonitorData, kind, seq, BpPatience());
            BpReadClock;
            IF wrong <> 0 THEN
                BpRefuse bpMonitorClient, bpMonitorData, seq, wrong, 0;
                RETURN BP_CLIENT_GONE;
            ENDIF
            IF kind >= 0 THEN
                bpHeard := bpNow;
                IF NOT isGreeted THEN
                    isGreeted := BpGreetMonitor(kind, seq);
                    IF NOT isGreeted RETURN BP_CLIENT_GONE;
                ELSE
                    BpObeyMonitor kind, seq;
                ENDIF
            ELSEIF bpNow - bpHeard > BP_WATCHDOG THEN
                RETURN BP_CLIENT_SILENT;
            ENDIF
            BpWatch;
            IF isGreeted BpTell;
        ENDWHILE
    ERROR
        IF ERRNO = ERR_SOCK_TIMEOUT AND kind < 0 TRYNEXT;
        RETURN BP_CLIENT_GONE;
    ENDFUNC

    ! How long to listen before looking around again: not past the next state (s).
    FUNC num BpPatience()
        VAR num time;

        time := bpStateDue - bpNow;
        IF time > 0.01 RETURN 0.01;
        IF time < 0.001 RETURN 0.001;
        RETURN time;
    ENDFUNC

    FUNC bool BpGreetMonitor(num kind, num seq)
        IF kind <> BP_HELLO OR RawBytesLen(bpMonitorData) <> 6 THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_NOT_PAIRED, 0;
            RETURN FALSE;
        ENDIF
        IF BpByte(bpMonitorData, 1) <> BP_MAJOR THEN
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_BAD_VERSION, 0;
            RETURN FALSE;
        ENDIF
        BpBegin bpMonitorData, BP_WELCOME, seq;
        BpAdd bpMonitorData, BP_MAJOR \Byte;
        BpAdd bpMonitorData, BP_MINOR \Byte;
        BpAdd bpMonitorData, bpEpoch \Long;
        BpAdd bpMonitorData, BP_QUEUE \Word;
        BpAdd bpMonitorData, BP_WATCHDOG * 1000 \Word;
        BpSend bpMonitorClient, bpMonitorData;
        RETURN TRUE;
    ENDFUNC

    PROC BpObeyMonitor(num kind, num seq)
        TEST kind
        CASE BP_PING:
            ! Having been heard is all.
        CASE BP_ASK_STATE:
            BpSendState seq;
        CASE BP_STOP:
            BpHoldPath BP_STOP_ORDERED;
            IF bpStopSeq <> 0 BpAccept bpMonitorClient, bpMonitorData, bpStopSeq, 0;
            bpStopSeq := seq;
        CASE BP_IDENTIFY:
            BpSendIdentity seq;
        CASE BP_ASK_SIGNALS:
            BpSendSignals seq;
        CASE BP_WRITE:
            BpDoWrite seq;
        CASE BP_PULSE:
            BpDoPulse seq;
        CASE BP_WAIT:
            BpBeginWait seq;
        DEFAULT:
            BpRefuse bpMonitorClient, bpMonitorData, seq, BP_UNKNOWN, 0;
        ENDTEST
    ENDPROC

    ! Time -------------------------------------------------------------------------------------

    PROC BpReadClock()
        bpNow := bpBase + ClkRead(bpClock \HighRes);
        IF bpNow > BP_TURN THEN
            bpBase := bpNow - BP_TURN;
            ClkReset bpClock;
            ClkStart bpClock;
            bpNow := bpBase;
            bpTurns := (bpTurns + 1) MOD 65536;
            bpHeard := bpHeard - BP_TURN;
            bpStateDue := bpStateDue - BP_TURN;
            bpRemindDue := bpRemindDue - BP_TURN;
            FOR i FROM 1 TO BP_WAITS DO
                wDue{i} := wDue{i} - BP_TURN;
            ENDFOR
        ENDIF
    ENDPROC

    ! Stopping ---------------------------------------------------------------------------------

    ! Brakes on the path, and demands that it is cleared.
    PROC BpHoldPath(num reason)
        bpHold := reason;
        BpBrake;
        BpDemand;
    ENDPROC

    ! What fails is tried again at the next look around.
    PROC BpBrake()
        IF bpIsHeld RETURN;
        StopMove \Quick \AllMotionTasks;
        bpIsHeld := TRUE;
    ERROR
        RETURN;
    ENDPROC

    PROC BpDemand()
        bpStopTick := bpStopTick + 1;
        IF bpStopTick > BP_MAX_COUNT bpStopTick := 1;
        bpRemindDue := bpNow + BP_REMIND;
    ENDPROC

    ! What forbids motion now.
    FUNC num BpForbidden()
        IF doBpEmStop = 1 RETURN BP_EMERGENCY_STOP;
        IF doBpRunchainOk = 0 RETURN BP_PROTECTIVE_STOP;
        IF doBpMotorOn = 0 RETURN BP_MOTORS_OFF;
        IF OpMode() <> OP_AUTO RETURN BP_NOT_IN_AUTO;
        IF doBpExecuting = 0 RETURN BP_PROGRAM_STOPPED;
        RETURN 0;
    ENDFUNC

    PROC BpWatch()
        VAR num reason;

        reason := BpForbidden();
        IF bpHold <> 0 BpBrake;
        IF reason <> 0 THEN
            IF bpHold <> reason BpHoldPath reason;
            IF doBpStill = 1 BpAnswerStop;
        ELSEIF bpHold <> 0 THEN
            IF bpClearedTick = bpStopTick THEN
                IF doBpStill = 1 BpRelease;
            ELSEIF bpNow > bpRemindDue THEN
                BpDemand;
            ENDIF
        ENDIF
    ENDPROC

    ! The path is empty and the arm stands: a new motion may come.
    PROC BpRelease()
        IF bpIsHeld StartMove \AllMotionTasks;
        bpIsHeld := FALSE;
        bpHold := 0;
        BpAnswerStop;
    ERROR
        ! Not yet: it is tried again.
        RETURN;
    ENDPROC

    PROC BpAnswerStop()
        IF bpStopSeq <> 0 BpAccept bpMonitorClient, bpMonitorData, bpStopSeq, 0;
        bpStopSeq := 0;
    ENDPROC

    ! Telling ----------------------------------------------------------------------------------

    ! What is due: the state, and the ends of waits.
    PROC BpTell()
        IF bpNow >= bpStateDue THEN
            bpStateDue := bpStateDue + BP_STATE_PERIOD;
            IF bpStateDue < bpNow bpStateDue := bpNow + BP_STATE_PERIOD;
            BpSendState 0;
        ENDIF
        FOR i FROM 1 TO BP_WAITS DO
            IF wSeq{i} <> 0 BpLookAtWait i;
        ENDFOR
    ENDPROC

    FUNC num BpFlags()
        VAR num flags;

        flags := doBpMotorOn + 8 * doBpEmStop + 32 * doBpExecuting;
        IF OpMode() = OP_AUTO flags := flags + 2;
        IF OpMode() = OP_MAN_TEST flags := flags + 4;
        IF doBpRunchainOk = 0 AND doBpEmStop = 0 flags := flags + 16;
        IF doBpStill = 0 flags := flags + 64;
        IF bpHasMotion flags := flags + 128;
        RETURN flags;
    ENDFUNC

    PROC BpSendState(num seq)
        VAR jointtarget joints;
        VAR robtarget place;

        joints := CJointT(\TaskName:="T_ROB1");
        place := CRobT(\TaskName:="T_ROB1" \Tool:=bpTool \WObj:=wobj0);
        BpBegin bpMonitorData, BP_STATE, seq;
        PackRawBytes bpTurns, bpMonitorData \Network, 9 \IntX:=UINT;
        PackRawBytes bpNow, bpMonitorData \Network, 11 \Float4;
        PackRawBytes BpFlags(), bpMonitorData \Network, 15 \IntX:=UINT;
        PackRawBytes bpHold, bpMonitorData \Network, 17 \IntX:=UINT;
        PackRawBytes bpStopTick, bpMonitorData \Network, 19 \IntX:=DINT;
        PackRawBytes bpActive, bpMonitorData \Network, 23 \IntX:=DINT;
        PackRawBytes joints.robax.rax_1, bpMonitorData \Network, 27 \Float4;
        PackRawBytes joints.robax.rax_2, bpMonitorData \Network, 31 \Float4;
        PackRawBytes joints.robax.rax_3, bpMonitorData \Network, 35 \Float4;
        PackRawBytes joints.robax.rax_4, bpMonitorData \Network, 39 \Float4;
        PackRawBytes joints.robax.rax_5, bpMonitorData \Network, 43 \Float4;
        PackRawBytes joints.robax.rax_6, bpMonitorData \Network, 47 \Float4;
        PackRawBytes place.trans.x, bpMonitorData \Network, 51 \Float4;
        PackRawBytes place.trans.y, bpMonitorData \Network, 55 \Float4;
        PackRawBytes place.trans.z, bpMonitorData \Network, 59 \Float4;
        PackRawBytes place.rot.q1, bpMonitorData \Network, 63 \Float4;
        PackRawBytes place.rot.q2, bpMonitorData \Network, 67 \Float4;
        PackRawBytes place.rot.q3, bpMonitorData \Network, 71 \Float4;
        PackRawBytes place.rot.q4, bpMonitorData \Network, 75 \Float4;
        PackRawBytes BpInputs(), bpMonitorData \Network, 79 \IntX:=UINT;
        PackRawBytes BpOutputs(), bpMonitorData \Network, 81 \IntX:=UINT;
        BpSend bpMonitorClient, bpMonitorData;
    ENDPROC

    PROC BpSendIdentity(num seq)
        BpBegin bpMonitorData, BP_IDENTITY, seq;
        BpAddText bpMonitorData, GetSysInfo(\RobotType);
        BpAddText bpMonitorData, GetSysInfo(\SerialNo);
        BpAddText bpMonitorData, GetSysInfo(\SWVersion);
        BpSend bpMonitorClient, bpMonitorData;
    ENDPROC

ENDMODULE
