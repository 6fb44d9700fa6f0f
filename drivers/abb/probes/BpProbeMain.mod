MODULE BpProbeMain
  PROC main()
    bpBegin;
    bpLanguage;
    bpNumbers;
    bpStrings;
    bpErrors;
    bpTraps;
    bpData;
    bpNote "end", "reached";
    EXIT;
  ENDPROC
ENDMODULE
