MODULE TcpServer
    ! Simple ascii protocol, line feed terminated
    !   ADD a b   -> OK <sum, 2 decimals>
    !   ECHO text -> ECHO:text
    !   SET n v   -> OK      register n (1..4)
    !   GET n     -> VAL <v, 3 decimals>
    !   QUIT      -> BYE and the socket is closed
    CONST num SERVER_PORT := 4000;
    CONST string SERVER_IP := "192.168.125.1";
    CONST string LF := "\0A";

    VAR socketdev serverSocket;
    VAR socketdev clientSocket;
    VAR string rxBuffer := "";
    VAR bool keepServing := TRUE;
    VAR string clientIp := "";
    PERS num registers{4} := [0, 0, 0, 0];
    PERS num nCommands := 0;
    PERS num nBad := 0;
    PERS num nLost := 0;

    PROC main()
        VAR string cmdLine;
        nCommands := 0; nBad := 0; nLost := 0;
        openServer;
        acceptClient;
        WHILE keepServing DO
            cmdLine := nextLine();
            handle cmdLine;
        ENDWHILE
        SocketClose clientSocket;
        SocketClose serverSocket;
        TPWrite "commands " \Num := nCommands;
        EXIT;
    ENDPROC

    PROC openServer()
        SocketCreate serverSocket;
        SocketBind serverSocket, SERVER_IP, SERVER_PORT;
        SocketListen serverSocket;
    ENDPROC

    PROC acceptClient()
        rxBuffer := "";
        SocketAccept serverSocket, clientSocket \ClientAddress := clientIp \Time := WAIT_MAX;
        TPWrite "client " + clientIp;
    ENDPROC

    ! the next line without its terminator; waits for more bytes if need be
    FUNC string nextLine()
        VAR string piece;
        VAR num at;
        VAR string result;
        WHILE NOT hasLine() DO
            SocketReceive clientSocket \Str := piece \Time := WAIT_MAX;
            rxBuffer := rxBuffer + piece;
        ENDWHILE
        at := StrFind(rxBuffer, 1, LF);
        IF at = 1 THEN
            result := "";
        ELSE
            result := StrPart(rxBuffer, 1, at - 1);
        ENDIF
        IF at < StrLen(rxBuffer) THEN
            rxBuffer := StrPart(rxBuffer, at + 1, StrLen(rxBuffer) - at);
        ELSE
            rxBuffer := "";
        ENDIF
        RETURN result;
    ERROR
        IF ERRNO = ERR_SOCK_CLOSED THEN
            Incr nLost;
            SocketClose clientSocket;
            acceptClient;
            RETRY;
        ENDIF
    ENDFUNC

    FUNC bool hasLine()
        IF rxBuffer = "" RETURN FALSE;
        RETURN StrFind(rxBuffer, 1, LF) <= StrLen(rxBuffer);
    ENDFUNC

    ! word number n of a line, "" if there are fewer
    FUNC string word(string text, num n)
        VAR num start := 1;
        VAR num upto;
        FOR i FROM 1 TO n DO
            IF start > StrLen(text) RETURN "";
            upto := StrFind(text, start, " ");
            IF i = n RETURN StrPart(text, start, upto - start);
            start := upto + 1;
        ENDFOR
        RETURN "";
    ENDFUNC

    PROC handle(string cmdLine)
        VAR num a;
        VAR num b;
        VAR bool ok;
        Incr nCommands;
        TEST word(cmdLine, 1)
        CASE "ADD":
            ok := StrToVal(word(cmdLine, 2), a);
            ok := StrToVal(word(cmdLine, 3), b) AND ok;
            IF ok THEN
                reply "OK " + NumToStr(a + b, 2);
            ELSE
                refuse 2, word(cmdLine, 2);
            ENDIF
        CASE "ECHO":
            reply "ECHO:" + StrPart(cmdLine, 6, StrLen(cmdLine) - 5);
        CASE "SET", "PUT":
            IF StrToVal(word(cmdLine, 2), a) AND StrToVal(word(cmdLine, 3), b) THEN
                registers{a} := b;
                reply "OK";
            ELSE
                refuse 2, word(cmdLine, 2);
            ENDIF
        CASE "GET":
            ok := StrToVal(word(cmdLine, 2), a);
            reply "VAL " + NumToStr(registers{a}, 3);
        CASE "QUIT":
            reply "BYE";
            keepServing := FALSE;
        DEFAULT:
            refuse 1, word(cmdLine, 1);
        ENDTEST
    ERROR (ERR_OUTOFBND)
        refuse 3, NumToStr(a, 0);
        RETURN;
    ENDPROC

    PROC refuse(num code, string what)
        Incr nBad;
        reply "ERR " + NumToStr(code, 0) + " " + what;
    ENDPROC

    PROC reply(string text)
        SocketSend clientSocket \Str := text + LF;
    ENDPROC
ENDMODULE
