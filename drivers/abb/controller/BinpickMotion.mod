MODULE BinpickMotion
    ! The motion task: takes targets from its one client, checks them, drives them, answers.
    ! It never begins a motion by itself: not after a stop, not after a new connection.

    CONST num BP_IS_JOINT := 1;
    CONST num BP_IS_LINEAR := 2;
    CONST num BP_IS_CIRCULAR := 3;

    VAR socketdev bpMotionListener;
    VAR socketdev bpMotionClient;
    VAR rawbytes bpMotionData;
    VAR intnum bpStopDemanded;
    VAR errnum BP_STOPPED_ERR := -1;

    ! The queue. Every target has joints: its own, or those of its pose.
    VAR num qCount := 0;
    VAR num qKind{BP_QUEUE};
    VAR robtarget qPose{BP_QUEUE};
    VAR robtarget qVia{BP_QUEUE};
    VAR jointtarget qJoints{BP_QUEUE};
    VAR num qSpeed{BP_QUEUE};
    VAR num qTime{BP_QUEUE};
    VAR zonedata qZone{BP_QUEUE};
    ! The target that is driven, or that was found wrong.
    VAR num qAt := 0;

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

    ! Queueing ---------------------------------------------------------------------------------

    PROC BpAddTarget(num seq, num kind, num size)
        VAR num wrong := 0;

        IF RawBytesLen(bpMotionData) <> size THEN
            wrong := BP_BAD_LENGTH;
        ELSEIF qCount >= BP_QUEUE THEN
            wrong := BP_QUEUE_FULL;
        ELSE
            qCount := qCount + 1;
            qKind{qCount} := kind;
            IF kind = BP_IS_JOINT THEN
                wrong := BpTakeJoints();
            ELSEIF kind = BP_IS_LINEAR THEN
                wrong := BpTakePose(1);
            ELSE
                wrong := BpTakeVia();
                IF wrong = 0 wrong := BpTakePose(29);
            ENDIF
        ENDIF
        IF wrong = 0 THEN
            BpAccept bpMotionClient, bpMotionData, seq, qCount;
        ELSE
            ! A queue with a hole must not be driven.
            BpRefuse bpMotionClient, bpMotionData, seq, wrong, qCount;
            qCount := 0;
        ENDIF
    ENDPROC

    ! Six joints (deg), share of the joint speeds, zone (mm).
    FUNC num BpTakeJoints()
        VAR robjoint joints;
        VAR num share;

        joints.rax_1 := BpFloat(bpMotionData, 1);
        joints.rax_2 := BpFloat(bpMotionData, 5);
        joints.rax_3 := BpFloat(bpMotionData, 9);
        joints.rax_4 := BpFloat(bpMotionData, 13);
        joints.rax_5 := BpFloat(bpMotionData, 17);
        joints.rax_6 := BpFloat(bpMotionData, 21);
        share := BpFloat(bpMotionData, 25);
        IF NOT (BpIsNumber(joints.rax_1) AND BpIsNumber(joints.rax_2) AND BpIsNumber(joints.rax_3)) RETURN BP_BAD_ARGUMENT;
        IF NOT (BpIsNumber(joints.rax_4) AND BpIsNumber(joints.rax_5) AND BpIsNumber(joints.rax_6)) RETURN BP_BAD_ARGUMENT;
        IF NOT (share > 0) RETURN BP_BAD_ARGUMENT;
        IF share > BP_MAX_JOINT_SHARE + 0.00001 RETURN BP_TOO_FAST;
        qJoints{qCount} := [joints, [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
        qSpeed{qCount} := share;
        RETURN BpTakeZone(BpFloat(bpMotionData, 29));
    ENDFUNC

    ! Position (mm), orientation, configuration, speed (mm/s), zone (mm).
    FUNC num BpTakePose(num at)
        VAR pos place;
        VAR orient turn;
        VAR confdata conf;
        VAR num speed;

        place := BpPos(bpMotionData, at);
        turn := BpOrient(bpMotionData, at + 12);
        UnpackRawBytes bpMotionData, at + 28, conf.cf1 \IntX:=SINT;
        UnpackRawBytes bpMotionData, at + 29, conf.cf4 \IntX:=SINT;
        UnpackRawBytes bpMotionData, at + 30, conf.cf6 \IntX:=SINT;
        UnpackRawBytes bpMotionData, at + 31, conf.cfx \IntX:=SINT;
        speed := BpFloat(bpMotionData, at + 32);
        IF NOT (BpIsPos(place) AND BpIsOrient(turn) AND BpIsNumber(speed)) RETURN BP_BAD_ARGUMENT;
        IF NOT (speed > 0) RETURN BP_BAD_ARGUMENT;
        IF speed > BP_MAX_SPEED + 0.01 RETURN BP_TOO_FAST;
        qPose{qCount} := [place, NOrient(turn), conf, [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
        qSpeed{qCount} := speed;
        RETURN BpTakeZone(BpFloat(bpMotionData, at + 36));
    ENDFUNC

    FUNC num BpTakeVia()
        VAR pos place;
        VAR orient turn;

        place := BpPos(bpMotionData, 1);
        turn := BpOrient(bpMotionData, 13);
        IF NOT (BpIsPos(place) AND BpIsOrient(turn)) RETURN BP_BAD_ARGUMENT;
        qVia{qCount} := [place, NOrient(turn), [0, 0, 0, 0], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];
        RETURN 0;
    ENDFUNC

    FUNC num BpTakeZone(num size)
        IF NOT (size >= 0 AND size <= 200) RETURN BP_BAD_ARGUMENT;
        IF size = 0 THEN
            qZone{qCount} := fine;
        ELSE
            qZone{qCount} := [FALSE, size, 1.5 * size, 1.5 * size, 0.15 * size, 1.5 * size, 0.15 * size];
        ENDIF
        RETURN 0;
    ENDFUNC

    ! Checking ---------------------------------------------------------------------------------

    ! Looks at all targets before the first is driven; fills in joints and times. Returns a code;
    ! qAt says at which target.
    FUNC num BpCheck()
        VAR jointtarget before;
        VAR num wrong;

        before := CJointT();
        FOR i FROM 1 TO qCount DO
            qAt := i;
            IF qKind{i} = BP_IS_JOINT THEN
                qTime{i} := BpJointTime(before.robax, qJoints{i}.robax) / qSpeed{i};
                wrong := BpCheckBox(BpPlaceOf(qJoints{i}));
            ELSE
                IF qKind{i} = BP_IS_CIRCULAR THEN
                    wrong := BpCheckBox(BpInBase(qVia{i}.trans));
                    IF wrong <> 0 RETURN wrong;
                ENDIF
                wrong := BpCheckBox(BpInBase(qPose{i}.trans));
                IF wrong = 0 qJoints{i} := CalcJointT(qPose{i}, bpTool \WObj:=bpWobj);
            ENDIF
            IF wrong <> 0 RETURN wrong;
            before := qJoints{i};
        ENDFOR
        RETURN 0;
    ERROR
        RETURN BpCodeOf(ERRNO);
    ENDFUNC

    FUNC pos BpPlaceOf(jointtarget joints)
        VAR robtarget there;

        there := CalcRobT(joints, bpTool);
        RETURN there.trans;
    ENDFUNC

    FUNC pos BpInBase(pos place)
        RETURN PoseVect(PoseMult(bpWobj.uframe, bpWobj.oframe), place);
    ENDFUNC

    FUNC num BpCheckBox(pos place)
        IF place.x < BP_BOX_MIN.x OR place.x > BP_BOX_MAX.x RETURN BP_OUTSIDE_BOX;
        IF place.y < BP_BOX_MIN.y OR place.y > BP_BOX_MAX.y RETURN BP_OUTSIDE_BOX;
        IF place.z < BP_BOX_MIN.z OR place.z > BP_BOX_MAX.z RETURN BP_OUTSIDE_BOX;
        RETURN 0;
    ENDFUNC

    ! How long the slowest joint needs at full speed.
    FUNC num BpJointTime(robjoint a, robjoint b)
        VAR num time := 0.002;

        BpLonger time, a.rax_1 - b.rax_1, BP_JOINT_SPEED.rax_1;
        BpLonger time, a.rax_2 - b.rax_2, BP_JOINT_SPEED.rax_2;
        BpLonger time, a.rax_3 - b.rax_3, BP_JOINT_SPEED.rax_3;
        BpLonger time, a.rax_4 - b.rax_4, BP_JOINT_SPEED.rax_4;
        BpLonger time, a.rax_5 - b.rax_5, BP_JOINT_SPEED.rax_5;
        BpLonger time, a.rax_6 - b.rax_6, BP_JOINT_SPEED.rax_6;
        RETURN time;
    ENDFUNC

    PROC BpLonger(INOUT num time, num angle, num speed)
        IF Abs(angle) / speed > time time := Abs(angle) / speed;
    ENDPROC

    FUNC num BpCodeOf(errnum number)
        TEST number
        CASE ERR_OUTSIDE_REACH:
            RETURN BP_OUT_OF_REACH;
        CASE ERR_ROBLIMIT:
            RETURN BP_JOINT_LIMIT;
        CASE ERR_PATH_STOP:
            RETURN BP_SINGULARITY;
        CASE ERR_MOTIONSUP:
            RETURN BP_COLLISION;
        DEFAULT:
            RETURN BP_INTERNAL;
        ENDTEST
    ENDFUNC

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

    ! Settings ---------------------------------------------------------------------------------

    ! Frame of the tool in the flange, mass, centre of gravity.
    PROC BpSetTool(num seq)
        VAR pose frame;
        VAR num wrong;

        IF RawBytesLen(bpMotionData) <> 44 THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_BAD_LENGTH, 0;
            RETURN;
        ENDIF
        frame.trans := BpPos(bpMotionData, 1);
        frame.rot := BpOrient(bpMotionData, 13);
        wrong := BpCheckLoad(29, bpLoad.mass);
        IF wrong = 0 AND NOT (BpIsPos(frame.trans) AND BpIsOrient(frame.rot)) wrong := BP_BAD_ARGUMENT;
        IF wrong <> 0 THEN
            BpRefuse bpMotionClient, bpMotionData, seq, wrong, 0;
            RETURN;
        ENDIF
        frame.rot := NOrient(frame.rot);
        bpTool := [TRUE, frame, BpLoadAt(29)];
        BpAccept bpMotionClient, bpMotionData, seq, 0;
    ENDPROC

    PROC BpSetWobj(num seq)
        VAR pose frame;

        IF RawBytesLen(bpMotionData) <> 28 THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_BAD_LENGTH, 0;
            RETURN;
        ENDIF
        frame.trans := BpPos(bpMotionData, 1);
        frame.rot := BpOrient(bpMotionData, 13);
        IF NOT (BpIsPos(frame.trans) AND BpIsOrient(frame.rot)) THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_BAD_ARGUMENT, 0;
            RETURN;
        ENDIF
        bpWobj.uframe.trans := frame.trans;
        bpWobj.uframe.rot := NOrient(frame.rot);
        BpAccept bpMotionClient, bpMotionData, seq, 0;
    ENDPROC

    ! Mass and centre of gravity of the part in the gripper.
    PROC BpSetLoad(num seq)
        VAR num wrong;

        IF RawBytesLen(bpMotionData) <> 16 THEN
            wrong := BP_BAD_LENGTH;
        ELSE
            wrong := BpCheckLoad(1, bpTool.tload.mass);
        ENDIF
        IF wrong <> 0 THEN
            BpRefuse bpMotionClient, bpMotionData, seq, wrong, 0;
            RETURN;
        ENDIF
        bpLoad := BpLoadAt(1);
        GripLoad bpLoad;
        BpAccept bpMotionClient, bpMotionData, seq, 0;
    ENDPROC

    FUNC num BpCheckLoad(num at, num other)
        VAR num mass;

        mass := BpFloat(bpMotionData, at);
        IF NOT (BpIsNumber(mass) AND BpIsPos(BpPos(bpMotionData, at + 4))) RETURN BP_BAD_ARGUMENT;
        IF mass < 0 RETURN BP_BAD_ARGUMENT;
        IF mass + other > BP_MAX_PAYLOAD + 0.005 RETURN BP_TOO_HEAVY;
        RETURN 0;
    ENDFUNC

    ! The controller wants some mass, off the flange, even where there is none.
    FUNC loaddata BpLoadAt(num at)
        VAR num mass;
        VAR pos centre;

        mass := BpFloat(bpMotionData, at);
        centre := BpPos(bpMotionData, at + 4);
        IF mass < 0.001 mass := 0.001;
        IF centre.x = 0 AND centre.y = 0 AND centre.z = 0 centre.z := 0.001;
        RETURN [mass, centre, [1, 0, 0, 0], 0, 0, 0];
    ENDFUNC

    ! Acceleration and its ramp (percent of the normal values).
    PROC BpSetAcc(num seq)
        VAR num acc;
        VAR num ramp;

        IF RawBytesLen(bpMotionData) <> 8 THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_BAD_LENGTH, 0;
            RETURN;
        ENDIF
        acc := BpFloat(bpMotionData, 1);
        ramp := BpFloat(bpMotionData, 5);
        IF NOT (acc >= 20 AND acc <= 100 AND ramp >= 10 AND ramp <= 100) THEN
            BpRefuse bpMotionClient, bpMotionData, seq, BP_BAD_ARGUMENT, 0;
            RETURN;
        ENDIF
        AccSet acc, ramp;
        BpAccept bpMotionClient, bpMotionData, seq, 0;
    ENDPROC
ENDMODULE
