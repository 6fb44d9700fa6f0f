MODULE BpProbeStrings
  PROC bpStrings()
    VAR num at;
    at := StrMatch("", 1, "x");
    bpNoteNum "strmatch-in-empty", at;
    bpFindBehind;
    bpPartBehind;
    bpTooLong;
    bpLines;
    bpRawFull;
    bpNoteNum "eof-num", EOF_NUM;
    bpNoteNum "wait-max", WAIT_MAX;
  ERROR
    bpNote "strmatch-in-empty", bpError(ERRNO);
    TRYNEXT;
  ENDPROC

  LOCAL PROC bpFindBehind()
    bpNoteNum "strfind-behind-end", StrFind("abc", 4, "x");
  ERROR
    bpNote "strfind-behind-end", bpError(ERRNO);
    RETURN;
  ENDPROC

  LOCAL PROC bpPartBehind()
    bpNote "strpart-behind-end", StrPart("abc", 2, 5);
  ERROR
    bpNote "strpart-behind-end", bpError(ERRNO);
    RETURN;
  ENDPROC

  LOCAL PROC bpTooLong()
    VAR string ten := "1234567890";
    VAR string s;
    FOR i FROM 1 TO 8 DO
      s := s + ten;
    ENDFOR
    bpNoteNum "string-holds-80", StrLen(s);
    s := s + "x";
    bpNoteNum "string-of-81", StrLen(s);
  ERROR
    bpNote "string-of-81", bpError(ERRNO);
    RETURN;
  ENDPROC

  LOCAL PROC bpLines()
    VAR iodev file;
    VAR string line;
    Open "HOME:"\File:="bpline.txt", file\Write;
    FOR i FROM 1 TO 10 DO
      Write file, "1234567890"\NoNewLine;
    ENDFOR
    Write file, "";
    Close file;
    Open "HOME:"\File:="bpline.txt", file\Read;
    line := ReadStr(file);
    bpNoteNum "readstr-of-100", StrLen(line);
    line := ReadStr(file);
    bpNoteNum "readstr-of-100-rest", StrLen(line);
    line := ReadStr(file);
    bpNoteBool "readstr-end", line = EOF;
    Close file;
    RemoveFile "HOME:/bpline.txt";
  ERROR
    bpNote "readstr-of-100", bpError(ERRNO);
    RETURN;
  ENDPROC

  LOCAL PROC bpRawFull()
    VAR rawbytes raw;
    FOR i FROM 1 TO 1024 DO
      PackRawBytes 1, raw, i\Hex1;
    ENDFOR
    bpNoteNum "rawbytes-holds-1024", RawBytesLen(raw);
    PackRawBytes 1, raw, 1025\Hex1;
    bpNote "rawbytes-of-1025", "no error";
  ERROR
    bpNote "rawbytes-of-1025", bpError(ERRNO);
    RETURN;
  ENDPROC
ENDMODULE
