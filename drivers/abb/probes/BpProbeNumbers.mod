MODULE BpProbeNumbers
  PROC bpNumbers()
    VAR num n := 16777216;
    VAR dnum d := 9007199254740992;
    n := n + 1;
    bpNoteBool "num-is-binary32", n = 16777216;
    d := d + 1;
    bpNoteBool "dnum-is-binary64", d = 9007199254740992;
    bpNoteNum "round-half-up", Round(2.5);
    bpNoteNum "round-half-negative", Round(-2.5);
    bpNote "numtostr-9e9", NumToStr(9E9, 0);
    bpNote "numtostr-small-negative", NumToStr(-0.001, 2);
    bpNote "numtostr-half", NumToStr(0.5, 0);
    bpNote "numtostr-exponent", NumToStr(1234.5, 2\Exp);
    bpNote "valtostr-digits", ValToStr(1.23456789);
    bpNote "valtostr-9e9", ValToStr(9E9);
    bpNote "valtostr-small", ValToStr(0.00001);
    bpNote "valtostr-string", ValToStr("a");
    bpRead "strtoval-leading-zeros", "007";
    bpRead "strtoval-plus", "+1.5";
    bpRead "strtoval-dot", ".25";
    bpRead "strtoval-exponent", "1e3";
    bpRead "strtoval-blanks", " 1 ";
    bpRead "strtoval-two", "1 2";
    bpRead "strtoval-empty", "";
    bpOverflow;
  ENDPROC

  LOCAL PROC bpRead(string id, string text)
    VAR num n;
    IF StrToVal(text, n) THEN
      bpNoteNum id, n;
    ELSE
      bpNote id, "refused";
    ENDIF
  ENDPROC

  LOCAL PROC bpOverflow()
    VAR num n := 3E38;
    n := n * 10;
    bpNoteNum "num-overflow", n;
  ERROR
    bpNote "num-overflow", bpError(ERRNO);
    RETURN;
  ENDPROC
ENDMODULE
