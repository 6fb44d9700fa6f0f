MODULE BpProbeMain
  PROC main()
    bpBegin;
    bpLanguage;
    bpNumbers;
    bpStrings;
    bpErrors;
    bpData;
    bpNote "end", "reached";
    EXIT;
  ENDPROC
ENDMODULE
