MODULE SockCorners
    ! what the first weeks of every socket program are about
    VAR socketdev srv;
    VAR socketdev cli;
    VAR socketdev other;
    PERS num acceptTimeouts := 0;
    PERS num addrInUse := 0;
    PERS num pieces{3} := [0, 0, 0];
    PERS num stBefore{4} := [-1, -1, -1, -1];
    PERS string firstPiece := "";
    PERS num closedSeen := 0;

    PROC main()
        acceptTimeouts := 0;
        addrInUse := 0;
        closedSeen := 0;
        status;
        patient;
        longText;
        lost;
        again;
        SocketClose srv;
        TPWrite "corners done";
        EXIT;
    ENDPROC

    PROC status()
        IF SocketGetStatus(srv) = SOCKET_CLOSED stBefore{1} := 1;
        SocketCreate srv;
        IF SocketGetStatus(srv) = SOCKET_CREATED stBefore{2} := 1;
        SocketBind srv, "192.168.125.1", 4400;
        IF SocketGetStatus(srv) = SOCKET_BOUND stBefore{3} := 1;
        SocketListen srv;
        IF SocketGetStatus(srv) = SOCKET_LISTENING stBefore{4} := 1;
        ! a second one on the same port
        SocketCreate other;
        SocketBind other, "192.168.125.1", 4400;
        TPWrite "never";
    ERROR
        IF ERRNO = ERR_SOCK_ADDR_INUSE THEN
            Incr addrInUse;
            SocketClose other;
            RETURN;
        ENDIF
        RAISE;
    ENDPROC

    PROC patient()
        TPWrite "waiting";
        SocketAccept srv, cli \Time := 0.5;
        IF SocketGetStatus(cli) = SOCKET_CONNECTED TPWrite "connected";
    ERROR
        IF ERRNO = ERR_SOCK_TIMEOUT THEN
            Incr acceptTimeouts;
            IF acceptTimeouts < 5 RETRY;
        ENDIF
        RAISE;
    ENDPROC

    ! 200 bytes do not fit in a string: they come 80, 80 and 40 at a time
    PROC longText()
        VAR string s;
        WaitTime 0.5;
        FOR i FROM 1 TO 3 DO
            SocketReceive cli \Str := s \Time := 5;
            pieces{i} := StrLen(s);
            IF i = 1 firstPiece := StrPart(s, 71, 10);
        ENDFOR
        SocketSend cli \Str := "got" + ValToStr(pieces{1} + pieces{2} + pieces{3});
    ENDPROC

    PROC lost()
        VAR rawbytes raw;
        SocketReceive cli \RawData := raw \Time := WAIT_MAX;
    ERROR (ERR_SOCK_CLOSED)
        Incr closedSeen;
        SocketClose cli;
        TRYNEXT;
    ENDPROC

    ! the same listener takes the next client
    PROC again()
        VAR byte data{4};
        VAR num n;
        SocketAccept srv, cli \Time := WAIT_MAX;
        SocketReceive cli \Data := data \ReadNoOfBytes := 4 \NoRecBytes := n \Time := 10;
        data{1} := data{1} + 1;
        SocketSend cli \Data := data \NoOfBytes := n;
        SocketClose cli;
    ENDPROC
ENDMODULE
