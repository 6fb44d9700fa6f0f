MODULE BinpickTargets
    ! The queue of targets: taken from frames, looked at as a whole before the first is driven.

    CONST num BP_IS_JOINT := 1;
    CONST num BP_IS_LINEAR := 2;
    CONST num BP_IS_CIRCULAR := 3;

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
ENDMODULE
