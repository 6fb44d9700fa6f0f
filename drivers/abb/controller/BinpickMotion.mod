MODULE BinpickMotion
    ! The motion task: takes targets from its one client, checks them, drives them, answers.
    ! It never begins a motion by itself: not after a stop, not after a new connection.

    VAR socketdev bpMotionListener;
    VAR socketdev bpMotionClient;
    VAR rawbytes bpMotionData;
    VAR intnum bpStopDemanded;
    VAR errnum BP_STOPPED_ERR := -1;

    PROC main()
        BpPrepare;
        WHILE TRUE DO
            BpAwaitClient;
            BpServe;
            BpDropClient;
        ENDWHILE
    ENDPROC

    ! After the program pointer was set to main: nothing is under way, and nothing is kept.
    PROC BpPrepare()
        BookErrNo BP_STOPPED_ERR;
        bpActive := 0;
        bpHasMotion := FALSE;
        qCount := 0;
        BpDropClient;
        ConfJ \Off;
        ConfL \Off;
        SingArea \Off;
        IDelete bpStopDemanded;
        CONNECT bpStopDemanded WITH BpStopTrap;
        IPers bpStopTick, bpStopDemanded;
        ClearPath;
        bpClearedTick := bpStopTick;
        TPWrite "binpick: ready for motion";
    ENDPROC

    ! The monitor holds the path already; here it is emptied, and the motion under way is left.
    TRAP BpStopTrap
        BpMeetStop;
        IF bpActive <> 0 THEN
            ! Raised once only: more stops may wait, and must not raise in the handler.
            bpActive := 0;
            RAISE BP_STOPPED_ERR;
        ENDIF
    ERROR
        RAISE;
    ENDTRAP

    ! Empties the path. What fails is demanded again.
    PROC BpMeetStop()
        VAR num tick;

        tick := bpStopTick;
        IF tick = bpClearedTick RETURN;
        StopMove \Quick;
        ClearPath;
        StartMove;
        bpClearedTick := tick;
    ERROR
        RETURN;
    ENDPROC

    ! One client at a time: while one is connected nobody listens, so a second one is refused.
    PROC BpAwaitClient()
        VAR string peer;
        VAR bool isHere := FALSE;

        WHILE NOT BpListen(bpMotionListener, BP_MOTION_PORT) DO
            WaitTime 0.1;
        ENDWHILE
        WHILE NOT isHere DO
            ! Looked at here too: for when interrupts do not come while a socket waits.
            BpMeetStop;
            isHere := BpMotionComes(peer);
        ENDWHILE
        IF BpMayConnect(peer) THEN
            SocketClose bpMotionListener;
            bpHasMotion := TRUE;
        ELSE
            TPWrite "binpick: refused " + peer;
            BpDropClient;
        ENDIF
    ERROR
        BpDropClient;
        RETURN;
    ENDPROC

    FUNC bool BpMotionComes(INOUT string peer)
        SocketAccept bpMotionListener, bpMotionClient \ClientAddress:=peer \Time:=0.2;
        RETURN TRUE;
    ERROR
        IF ERRNO = ERR_SOCK_TIMEOUT RETURN FALSE;
        RAISE;
    ENDFUNC

    PROC BpDropClient()
        bpHasMotion := FALSE;
        qCount := 0;
        SocketClose bpMotionClient;
        SocketClose bpMotionListener;
    ERROR
        TRYNEXT;
    ENDPROC

    ! Serves until the client goes, errs, or its monitor connection is gone.
    PROC BpServe()
        VAR num kind;
        VAR num seq;
        VAR num wrong;
        VAR num epoch := 0;

        WHILE bpHasMotion DO
            ! Below 0: nothing has come.
            kind := -1;
            wrong := 0;
            BpMeetStop;
            wrong := BpReceive(bpMotionClient, bpMotionData, kind, seq, 0.2);
            IF wrong <> 0 THEN
                BpRefuse bpMotionClient, bpMotionData, seq, wrong, 0;
                RETURN;
            ENDIF
            IF epoch = 0 THEN
                IF kind = BP_HELLO epoch := BpGreet(seq);
                IF kind >= 0 AND kind <> BP_HELLO BpRefuse bpMotionClient, bpMotionData, seq, BP_NOT_PAIRED, 0;
                IF epoch = 0 RETURN;
            ELSEIF epoch <> bpEpoch OR NOT bpHasMonitor THEN
                RETURN;
            ELSEIF kind >= 0 THEN
                BpObey kind, seq;
            ENDIF
        ENDWHILE
    ERROR
        IF ERRNO = ERR_SOCK_TIMEOUT AND kind < 0 TRYNEXT;
        RETURN;
    ENDPROC

    ! Pairs this connection with the monitor's. Returns the epoch, or 0.
    FUNC num BpGreet(num seq)
        VAR num major := 0;
        VAR num epoch := 0;

        IF RawBytesLen(bpMotionData) = 6 THEN
            major := BpByte(bpMotionData, 1);
            epoch := BpLong(bpMotionData, 3);
        ENDIF
        IF major <> BP_MAJOR THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_BAD_VERSION, 0;
            RETURN 0;
        ENDIF
        IF epoch = 0 OR epoch <> bpEpoch OR NOT bpHasMonitor THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_NOT_PAIRED, 0;
            RETURN 0;
        ENDIF
        BpBegin bpMotionData, BP_WELCOME, seq;
        BpAdd bpMotionData, BP_MAJOR \Byte;
        BpAdd bpMotionData, BP_MINOR \Byte;
        BpAdd bpMotionData, epoch \Long;
        BpAdd bpMotionData, BP_QUEUE \Word;
        BpAdd bpMotionData, BP_WATCHDOG * 1000 \Word;
        BpSend bpMotionClient, bpMotionData;
        RETURN epoch;
    ENDFUNC

    PROC BpObey(num kind, num seq)
        TEST kind
        CASE BP_ADD_JOINT:
            BpAddTarget seq, BP_IS_JOINT, 32;
        CASE BP_ADD_LINEAR:
            BpAddTarget seq, BP_IS_LINEAR, 40;
        CASE BP_ADD_CIRCULAR:
            BpAddTarget seq, BP_IS_CIRCULAR, 68;
        CASE BP_RUN:
            BpRun seq;
        CASE BP_DROP:
            qCount := 0;
            BpAccept bpMotionClient, bpMotionData, seq, 0;
        CASE BP_SET_TOOL:
            BpSetTool seq;
        CASE BP_SET_WOBJ:
            BpSetWobj seq;
        CASE BP_SET_LOAD:
            BpSetLoad seq;
        CASE BP_SET_ACC:
            BpSetAcc seq;
        DEFAULT:
            BpRefuse bpMotionClient, bpMotionData, seq, BP_UNKNOWN, 0;
        ENDTEST
    ENDPROC

    ! Driving ----------------------------------------------------------------------------------

    PROC BpRun(num seq)
        VAR num id;
        VAR num count;
        VAR num tick;
        VAR num wrong := 0;

        IF RawBytesLen(bpMotionData) <> 10 THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_BAD_LENGTH, 0;
            RETURN;
        ENDIF
        id := BpLong(bpMotionData, 1);
        count := BpWord(bpMotionData, 5);
        tick := BpLong(bpMotionData, 7);
        qAt := 0;
        IF id < 1 OR id > BP_MAX_COUNT OR count < 1 OR count <> qCount THEN
            wrong := BP_BAD_ARGUMENT;
        ELSEIF bpHold <> 0 THEN
            wrong := bpHold;
        ELSEIF tick <> bpStopTick THEN
            ! A stop has come since the client last looked.
            wrong := BP_STOP_ORDERED;
        ELSE
            wrong := BpCheck();
        ENDIF
        IF wrong <> 0 THEN
            qCount := 0;
            BpRefuse bpMotionClient, bpMotionData, seq, wrong, qAt;
            RETURN;
        ENDIF
        qAt := 0;
        BpAccept bpMotionClient, bpMotionData, seq, id;
        wrong := BpDrive(id, tick);
        qCount := 0;
        BpReport seq, id, wrong;
    ENDPROC

    ! Drives the queue to a standstill at its last target. Returns a code.
    FUNC num BpDrive(num id, num tick)
        VAR num code;

        bpActive := id;
        FOR i FROM 1 TO qCount DO
            IF tick <> bpStopTick RAISE BP_STOPPED_ERR;
            qAt := i;
            IF i = qCount qZone{i} := fine;
            TEST qKind{i}
            CASE BP_IS_JOINT:
                MoveAbsJ qJoints{i} \NoEOffs, v1000 \T:=qTime{i}, qZone{i}, bpTool;
            CASE BP_IS_LINEAR:
                MoveL qPose{i}, [qSpeed{i}, 500, 5000, 1000], qZone{i}, bpTool \WObj:=bpWobj;
            CASE BP_IS_CIRCULAR:
                MoveC qVia{i}, qPose{i}, [qSpeed{i}, 500, 5000, 1000], qZone{i}, bpTool \WObj:=bpWobj;
            ENDTEST
        ENDFOR
        WaitRob \ZeroSpeed;
        IF tick <> bpStopTick RAISE BP_STOPPED_ERR;
        bpActive := 0;
        RETURN 0;
    ERROR
        code := BpGaveUp(ERRNO);
        bpActive := 0;
        RETURN code;
    ENDFUNC

    ! A motion that failed leaves nothing on the path.
    FUNC num BpGaveUp(errnum number)
        IF number = BP_STOPPED_ERR RETURN BP_STOP_ORDERED;
        StopMove;
        ClearPath;
        StartMove;
        RETURN BpCodeOf(number);
    ERROR
        TRYNEXT;
    ENDFUNC

    PROC BpReport(num seq, num id, num code)
        VAR num result := BP_IS_DONE;

        IF code = BP_STOP_ORDERED THEN
            result := BP_IS_STOPPED;
        ELSEIF code <> 0 THEN
            result := BP_IS_FAILED;
        ENDIF
        BpBegin bpMotionData, BP_OUTCOME, seq;
        BpAdd bpMotionData, result \Byte;
        BpAdd bpMotionData, code \Word;
        BpAdd bpMotionData, id \Long;
        BpAdd bpMotionData, qAt \Word;
        BpSend bpMotionClient, bpMotionData;
    ENDPROC

ENDMODULE
