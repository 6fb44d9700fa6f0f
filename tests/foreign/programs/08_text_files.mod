MODULE FileLog
  !-- production log with rotation, recipe reader --------------------
  !-- s.okafor, commissioning ----------------------------------------
  CONST string stDir:="HOME:";
  CONST string stLog:="prod.log";
  CONST string stOld:="prod.1.log";
  CONST num nMaxBytes:=50;

  VAR iodev fLog;
  VAR iodev fRecipe;
  VAR iodev fBin;

  PERS num nSpeed:=0;
  PERS num nCount:=0;
  PERS string stName:="";
  PERS num nLines:=0;
  PERS num nUnknown:=0;
  PERS bool bMissingSeen:=FALSE;
  PERS num nRotations:=0;
  PERS num nBinSum:=0;
  PERS num nBinEof:=0;

  PROC main()
    nLines:=0;
    nUnknown:=0;
    nRotations:=0;
    readRecipe "recipe.txt";
    readMissing;
    FOR i FROM 1 TO 7 DO
      logLine "part "+NumToStr(i,0)+" len "+NumToStr(100+i/2,1);
    ENDFOR
    closing;
    binary;
    TPWrite stName\Num:=nSpeed;
    EXIT;
  ENDPROC

  PROC readRecipe(string file)
    VAR string s;
    Open stDir\File:=file,fRecipe\Read;
    s:=ReadStr(fRecipe);
    WHILE s<>EOF DO
      nLines:=nLines+1;
      IF s<>"" AND StrPart(s+" ",1,1)<>"#" useLine s;
      s:=ReadStr(fRecipe);
    ENDWHILE
    Close fRecipe;
  ENDPROC

  PROC useLine(string s)
    VAR num at;
    VAR string key;
    VAR string value;
    VAR bool ok:=TRUE;
    at:=StrFind(s,1,"=");
    IF at>StrLen(s) THEN
      nUnknown:=nUnknown+1;
      RETURN;
    ENDIF
    key:=StrPart(s,1,at-1);
    value:=StrPart(s,at+1,StrLen(s)-at);
    IF key="speed" THEN
      ok:=StrToVal(value,nSpeed);
    ELSEIF key="count" THEN
      ok:=StrToVal(value,nCount);
    ELSEIF key="name" THEN
      stName:=value;
    ELSE
      ok:=FALSE;
    ENDIF
    IF NOT ok Incr nUnknown;
  ENDPROC

  PROC readMissing()
    VAR iodev f;
    bMissingSeen:=FALSE;
    Open stDir\File:="no_such_file.txt",f\Read;
  ERROR
    bMissingSeen:=TRUE;
    TRYNEXT;
  ENDPROC

  PROC logLine(string stLine)
    rotate;
    Open stDir\File:=stLog,fLog\Append;
    Write fLog,stLine;
    Close fLog;
  ENDPROC

  PROC rotate()
    IF NOT IsFile(stDir+"/"+stLog) RETURN;
    IF FileSize(stDir+"/"+stLog)<nMaxBytes RETURN;
    IF IsFile(stDir+"/"+stOld) RemoveFile stDir+"/"+stOld;
    RenameFile stDir+"/"+stLog,stDir+"/"+stOld;
    nRotations:=nRotations+1;
  ENDPROC

  PROC closing()
    Open stDir\File:=stLog,fLog\Append;
    Write fLog,"total "\Num:=7;
    Write fLog,"ok "\Bool:=TRUE\NoNewLine;
    Write fLog,"; at "\Pos:=[1.5,-2,0];
    Close fLog;
  ENDPROC

  PROC binary()
    VAR rawbytes rb;
    VAR num b;
    PackRawBytes 1,rb,1\IntX:=USINT;
    PackRawBytes 515,rb\Network,2\IntX:=UINT;
    Open stDir\File:="data.bin",fBin\Write\Bin;
    WriteRawBytes fBin,rb;
    Close fBin;
    ClearRawBytes rb;
    nBinSum:=0;
    nBinEof:=0;
    Open stDir\File:="data.bin",fBin\Read\Bin;
    ReadRawBytes fBin,rb;
    FOR i FROM 1 TO 3 DO
      UnpackRawBytes rb,i,b\IntX:=USINT;
      nBinSum:=nBinSum+b;
    ENDFOR
    ReadRawBytes fBin,rb;
    Close fBin;
  ERROR
    IF ERRNO=ERR_RANYBIN_EOF THEN
      nBinEof:=nBinEof+1;
      TRYNEXT;
    ENDIF
  ENDPROC
ENDMODULE
