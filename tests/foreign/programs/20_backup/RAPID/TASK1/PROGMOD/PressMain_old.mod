MODULE PressMain
  ! left over from last year, not loaded
  PROC main()
    TPWrite "the wrong program";
    EXIT;
  ENDPROC
ENDMODULE
