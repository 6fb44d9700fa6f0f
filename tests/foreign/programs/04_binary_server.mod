MODULE BinSrv(SYSMODULE,NOSTEPIN)
  ! length(2, big endian) opcode(1) payload
  ! 16#01 add two floats, 16#02 reverse text, 16#03 store dint, 16#7F bye
  LOCAL CONST num OP_ADD:=1;
  LOCAL CONST num OP_REV:=2;
  LOCAL CONST num OP_STORE:=3;
  LOCAL CONST num OP_BYE:=127;
  LOCAL VAR socketdev sckListen;
  LOCAL VAR socketdev sckPeer;
  LOCAL VAR rawbytes rbIn;
  LOCAL VAR rawbytes rbOut;
  PERS num stored{3}:=[0,0,0];
  PERS num frames:=0;
  VAR num lastLength:=-1;

  PROC main()
    VAR num op;
    VAR bool more:=TRUE;

    frames:=0;
    SocketCreate sckListen;
    SocketBind sckListen,"0.0.0.0",4010;
    SocketListen sckListen;
    SocketAccept sckListen,sckPeer\Time:=WAIT_MAX;
    WHILE more DO
      op:=ReadFrame(rbIn);
      frames:=frames+1;
      TEST op
      CASE OP_ADD:
        DoAdd;
      CASE OP_REV:
        DoReverse;
      CASE OP_STORE:
        DoStore;
      CASE OP_BYE:
        Begin op;
        Finish;
        more:=FALSE;
      DEFAULT:
        Begin 255;
        PackRawBytes op,rbOut,RawBytesLen(rbOut)+1\IntX:=USINT;
        Finish;
      ENDTEST
    ENDWHILE
    SocketClose sckPeer;
    SocketClose sckListen;
    EXIT;
  ENDPROC

  ! Reads the header, then as many bytes as it says. Returns the opcode.
  LOCAL FUNC num ReadFrame(VAR rawbytes rb)
    VAR num length;
    VAR num op;
    VAR num got;
    VAR rawbytes head;
    SocketReceive sckPeer\RawData:=head\ReadNoOfBytes:=3\Time:=WAIT_MAX;
    UnpackRawBytes head\Network,1,length\IntX:=UINT;
    UnpackRawBytes head\Network,3,op\IntX:=USINT;
    lastLength:=length;
    ClearRawBytes rb;
    IF length>1 THEN
      SocketReceive sckPeer\RawData:=rb\ReadNoOfBytes:=length-1\NoRecBytes:=got\Time:=WAIT_MAX;
      IF got<>length-1 TPWrite "short frame";
    ENDIF
    RETURN op;
  ENDFUNC

  LOCAL PROC Begin(num op)
    ClearRawBytes rbOut;
    ! room for the length, known only at the end
    PackRawBytes 0,rbOut\Network,1\IntX:=UINT;
    PackRawBytes op,rbOut,3\IntX:=USINT;
  ENDPROC

  LOCAL PROC Finish()
    PackRawBytes RawBytesLen(rbOut)-2,rbOut\Network,1\IntX:=UINT;
    SocketSend sckPeer\RawData:=rbOut\NoOfBytes:=RawBytesLen(rbOut);
  ENDPROC

  LOCAL PROC DoAdd()
    VAR num a;
    VAR num b;
    UnpackRawBytes rbIn\Network,1,a\Float4;
    UnpackRawBytes rbIn\Network,5,b\Float4;
    Begin 129;
    PackRawBytes a+b,rbOut\Network,(RawBytesLen(rbOut)+1)\Float4;
    Finish;
  ENDPROC

  LOCAL PROC DoReverse()
    VAR string s;
    VAR string r:="";
    VAR num n;
    n:=RawBytesLen(rbIn);
    UnpackRawBytes rbIn,1,s\ASCII:=n;
    FOR i FROM n TO 1 STEP -1 DO
      r:=r+StrPart(s,i,1);
    ENDFOR
    Begin 130;
    PackRawBytes r,rbOut,RawBytesLen(rbOut)+1\ASCII;
    Finish;
  ENDPROC

  LOCAL PROC DoStore()
    VAR rawbytes rbCopy;
    VAR byte bMark;
    ! little endian here, and an INT and a hex byte after it
    UnpackRawBytes rbIn,1,stored{1}\IntX:=DINT;
    UnpackRawBytes rbIn,5,stored{2}\IntX:=INT;
    UnpackRawBytes rbIn,7,bMark\Hex1;
    stored{3}:=bMark;
    CopyRawBytes rbIn,5,rbCopy,1\NoOfBytes:=3;
    Begin 131;
    CopyRawBytes rbCopy,1,rbOut,RawBytesLen(rbOut)+1;
    Finish;
  ENDPROC
ENDMODULE
