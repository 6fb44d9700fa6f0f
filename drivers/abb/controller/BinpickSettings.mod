MODULE BinpickSettings
    ! Tool, work object, load and acceleration, as the client tells them and as the limits allow.

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
