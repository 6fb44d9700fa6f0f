MODULE VisionLink

   ! ============================================================
   ! Camera client.  The camera is the server (port 5050).
   ! TRIG -> "x;y;angle" CR    or "NOK" CR
   ! ============================================================

   RECORD camresult
      bool found;
      num x;
      num y;
      num angle;
   ENDRECORD

   CONST string CAM_IP:="192.168.125.50";
   CONST num CAM_PORT:=5050;
   VAR socketdev sCam;
   PERS num nTimeouts:=0;
   PERS num nReconnects:=0;
   PERS num nFound:=0;
   PERS pos posParts{3}:=[[0,0,0],[0,0,0],[0,0,0]];
   VAR camresult last;

   PROC main()
      nTimeouts:=0;
      nReconnects:=0;
      nFound:=0;
      connectCam;
      FOR shot FROM 1 TO 4 DO
         last:=takePicture();
         IF last.found THEN
            nFound:=nFound+1;
            posParts{nFound}:=[last.x,last.y,last.angle];
            TPWrite "Part at "\Pos:=posParts{nFound};
         ELSE
            TPWrite "Nothing in shot "+NumToStr(shot,0);
         ENDIF
      ENDFOR
      SocketSend sCam\Str:="BYE\0D";
      SocketClose sCam;
      EXIT;
   ENDPROC

   PROC connectCam()
      VAR socketstatus st;
      SocketCreate sCam;
      SocketConnect sCam,CAM_IP,CAM_PORT\Time:=5;
      st:=SocketGetStatus(sCam);
      IF st<>SOCKET_CONNECTED THEN
         TPWrite "not connected";
         EXIT;
      ENDIF
   ENDPROC

   FUNC camresult takePicture()
      VAR camresult r;
      VAR string answer;
      VAR num retries:=0;
      SocketSend sCam\Str:="TRIG\0D";
      SocketReceive sCam\Str:=answer\Time:=1;
      RETURN parse(answer);
   ERROR
      IF ERRNO=ERR_SOCK_TIMEOUT THEN
         retries:=retries+1;
         nTimeouts:=nTimeouts+1;
         IF retries<3 RETRY;
         r.found:=FALSE;
         RETURN r;
      ELSEIF ERRNO=ERR_SOCK_CLOSED THEN
         nReconnects:=nReconnects+1;
         SocketClose sCam;
         connectCam;
         SocketSend sCam\Str:="TRIG\0D";
         RETRY;
      ENDIF
   ENDFUNC

   FUNC camresult parse(string answer)
      VAR camresult r;
      VAR num semi1;
      VAR num semi2;
      VAR num cr;
      VAR bool ok:=TRUE;
      r:=[FALSE,0,0,0];
      IF StrPart(answer,1,3)="NOK" RETURN r;
      semi1:=StrFind(answer,1,";");
      semi2:=StrFind(answer,semi1+1,";");
      cr:=StrFind(answer,1,"\0D");
      ok:=ok AND StrToVal(StrPart(answer,1,semi1-1),r.x);
      ok:=ok AND StrToVal(StrPart(answer,semi1+1,semi2-semi1-1),r.y);
      ok:=ok AND StrToVal(StrPart(answer,semi2+1,cr-semi2-1),r.angle);
      r.found:=ok;
      RETURN r;
   ENDFUNC

ENDMODULE
