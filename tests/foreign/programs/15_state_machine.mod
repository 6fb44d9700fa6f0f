MODULE StateMachine
	! Clamp and press station - one state per CASE, state number on goState

	CONST num ST_IDLE:=1;
	CONST num ST_CLAMP:=2;
	CONST num ST_PRESS:=3;
	CONST num ST_DOOR:=4;
	CONST num ST_RELEASE:=5;
	CONST num ST_END:=9;

	VAR num nState:=0;
	VAR bool bLate;
	VAR intnum iPulse;
	VAR clock ckPress;
	PERS num nLate:=0;
	PERS num nPulses:=0;
	PERS num nGroup:=0;
	PERS num tPress:=0;
	PERS num nMaxTime:=0;
	PERS num nLimit:=0;
	PERS bool bReads:=FALSE;
	PERS bool bDoorOk:=FALSE;
	PERS bool bInTime:=TRUE;

	PROC main()
		rInit;
		WHILE nState<>ST_END DO
			SetGO goState,nState;
			rStep;
		ENDWHILE
		SetGO goState,ST_END;
		rBadThings;
		WaitTime 0.3;
		TPWrite "end";
		EXIT;
	ENDPROC

	PROC rInit()
		nLate:=0;
		nPulses:=0;
		nGroup:=0;
		Reset do1;
		Reset do5;
		Set do7;
		InvertDO do7;
		InvertDO do8;
		IDelete iPulse;
		CONNECT iPulse WITH tPulse;
		ISignalDO do4,1,iPulse;
		nState:=ST_IDLE;
		TPWrite "ready";
	ENDPROC

	PROC rStep()
		TEST nState
		CASE ST_IDLE:
			WaitDI di1,1\MaxTime:=0.5\TimeFlag:=bLate;
			IF bLate THEN
				nLate:=nLate+1;
				PulseDO\PLength:=0.1,do4;
			ELSE
				nState:=ST_CLAMP;
			ENDIF
		CASE ST_CLAMP:
			Set do1;
			WaitDO do1,1;
			nGroup:=nGroup*10+GOutput(goState);
			PulseDO\PLength:=0.2,do4;
			nState:=ST_PRESS;
		CASE ST_PRESS:
			nGroup:=nGroup*10+goState;
			ClkReset ckPress;
			ClkStart ckPress;
			SetDO\SDelay:=0.4,do5,1;
			WaitDO do5,1;
			ClkStop ckPress;
			tPress:=ClkRead(ckPress);
			nState:=ST_DOOR;
		CASE ST_DOOR:
			TPWrite "open the door";
			WaitUntil di2=1 AND DInput(di1)=1\MaxTime:=10\TimeFlag:=bLate;
			bDoorOk:=NOT bLate;
			bReads:=TestDI(di2) AND NOT TestDI(di3) AND DOutput(do1)=1 AND do5=high;
			nState:=ST_RELEASE;
		CASE ST_RELEASE:
			SetDO do1,low;
			WaitDI di1,0;
			nState:=ST_END;
		DEFAULT:
			TPWrite "unknown state "\Num:=nState;
			Stop;
		ENDTEST
	ENDPROC

	PROC rBadThings()
		WaitUntil TRUE\MaxTime:=1\TimeFlag:=bInTime;
		WaitDI di3,1\MaxTime:=0.2;
		SetGO goState,16;
	ERROR
		IF ERRNO=ERR_WAIT_MAXTIME THEN
			Incr nMaxTime;
			TRYNEXT;
		ELSEIF ERRNO=ERR_GO_LIM THEN
			Incr nLimit;
			TRYNEXT;
		ENDIF
	ENDPROC

	TRAP tPulse
		Incr nPulses;
	ENDTRAP
ENDMODULE
