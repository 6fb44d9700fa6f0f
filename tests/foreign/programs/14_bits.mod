MODULE BitsAndBytes
  !
  ! Checksums for a small serial protocol.
  ! Autor: J. Ferreira  -  comentários em português
  !
  CONST num POLY:=0x07;
  CONST num TOP:=8;
  VAR byte frame{9}:=[49,50,51,52,53,54,55,56,57];
  PERS num crc8:=-1;
  PERS num lrc:=-1;
  PERS num sum8:=-1;
  PERS num bitsOut{12}:=[0,0,0,0,0,0,0,0,0,0,0,0];
  PERS string text{6}:=["","","","","",""];
  PERS bool flags{4}:=[FALSE,FALSE,FALSE,FALSE];
  PERS num single:=0;
  PERS bool doubleKept:=FALSE;
  PERS num parity{4}:=[0,0,0,0];

  PROC main()
    crc8:=crcOf(frame);
    lrc:=lrcOf(frame);
    sum8:=sumOf(frame);
    basics;
    conversions;
    widths;
    FOR i FROM 1 TO 4 DO
      parity{i}:=parityOf(frame{i});
    ENDFOR
    TPWrite "CRC "+ByteToStr(crc8\Hex)+" LRC "+ByteToStr(lrc\Hex);
    EXIT;
  ENDPROC

  ! CRC-8, polinómio 07, valor inicial 0
  FUNC num crcOf(byte data{*})
    VAR byte crc:=0;
    FOR i FROM 1 TO Dim(data,1) DO
      crc:=BitXOr(crc,data{i});
      FOR bit FROM 1 TO 8 DO
        IF BitCheck(crc,TOP) THEN
          crc:=BitXOr(BitLSh(crc,1),POLY);
        ELSE
          crc:=BitLSh(crc,1);
        ENDIF
      ENDFOR
    ENDFOR
    RETURN crc;
  ENDFUNC

  FUNC byte lrcOf(byte data{*})
    VAR byte x;
    FOR i FROM 1 TO Dim(data,1) DO
      x:=BitXOr(x,data{i});
    ENDFOR
    RETURN x;
  ENDFUNC

  FUNC num sumOf(byte data{*})
    VAR num total:=0;
    FOR i FROM 1 TO Dim(data,1) DO
      total:=(total+data{i}) MOD 256;
    ENDFOR
    RETURN total;
  ENDFUNC

  FUNC num parityOf(byte b)
    VAR num n:=0;
    FOR i FROM 1 TO 8 DO
      IF BitCheck(b,i) n:=n+1;
    ENDFOR
    RETURN n MOD 2;
  ENDFUNC

  PROC basics()
    VAR byte a:=38;   ! 00100110
    VAR byte b:=34;   ! 00100010
    VAR byte c:=0;
    bitsOut{1}:=BitAnd(a,b);
    bitsOut{2}:=BitOr(a,129);
    bitsOut{3}:=BitXOr(a,b);
    bitsOut{4}:=BitNeg(a);
    bitsOut{5}:=BitLSh(a,3);
    bitsOut{6}:=BitRSh(a,2);
    BitSet c,8;
    BitSet c,1;
    bitsOut{7}:=c;
    BitClear c,8;
    bitsOut{8}:=c;
    bitsOut{9}:=17 DIV 5;
    bitsOut{10}:=17 MOD 5;
    bitsOut{11}:=0b1010+0o17+0xff;
    bitsOut{12}:=Trunc(-2.7)+Round(2.5149\Dec:=2)*100;
    flags{1}:=BitCheck(a,2);
    flags{2}:=BitCheck(a,1);
    flags{3}:=TRUE XOR FALSE;
    flags{4}:=NOT FALSE AND (TRUE XOR TRUE);
  ENDPROC

  PROC conversions()
    VAR byte b;
    text{1}:=ByteToStr(5\Hex);
    text{2}:=ByteToStr(10\Bin);
    text{3}:=ByteToStr(9\Okt);
    text{4}:=ByteToStr(65\Char);
    b:=StrToByte("F4"\Hex);
    text{5}:=NumToStr(b,0);
    text{6}:=NumToStr(StrToByte("A"\Char)+StrToByte("00001111"\Bin),0);
  ENDPROC

  ! um num tem 24 bits, um dnum 53
  PROC widths()
    VAR num n:=16777216;
    VAR dnum d:=16777216;
    n:=n+1;
    d:=d+1;
    single:=n-16777216;
    doubleKept:=(d-16777216)=1;
    IF BitXOrDnum(4294967295,1)<>4294967294 doubleKept:=FALSE;
  ENDPROC
ENDMODULE
