MODULE StringTests
CONST string QUOTE:="""";
PERS string out{24}:=["","","","","","","","","","","","","","","","","","","","","","","",""];
PERS bool okFlags{12}:=[FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE];
PERS num values{12}:=[0,0,0,0,0,0,0,0,0,0,0,0];
PERS num found{8}:=[0,0,0,0,0,0,0,0];
PERS num tooLong:=0;
PERS string longest:="";
PERS pos p:=[0,0,0];
PERS bool b:=FALSE;
VAR num k:=0;

PROC main()
	k:=0;
	tooLong:=0;
	format_numbers;
	format_values;
	parse_numbers;
	parse_values;
	search;
	limit;
	! the longest line is 80 characters
	TPWrite QUOTE+StrPart(longest,79,2)+QUOTE;
	EXIT;
ENDPROC

PROC put(string s)
	k:=k+1;
	out{k}:=s;
ENDPROC

PROC format_numbers()
	put NumToStr(-1.1,2);
	put NumToStr(0,2);
	put NumToStr(0.38521,3);
	put NumToStr(2.6,0);
	put NumToStr(1234.5,1);
	put NumToStr(-.25,2);
	put NumToStr(99.996,2);
ENDPROC

PROC format_values()
	VAR pos point:=[1,2.5,-3];
	put ValToStr(point);
	put ValToStr(TRUE);
	put ValToStr(0.5);
	put ByteToStr(122);
	put ByteToStr(122\Hex);
	put ByteToStr(122\Char);
	put StrMap("aBc-1",STR_LOWER,STR_UPPER);
	put StrFormat("{1} of {2}"\Arg1:="3"\Arg2:="7");
	put "a""b"+"\5C"+"c";
	put "back\\slash";
	put "x"+"\41\42"+"y";
ENDPROC

PROC parse(num i,string s)
	VAR num v:=-1;
	okFlags{i}:=StrToVal(s,v);
	IF okFlags{i} values{i}:=v;
ENDPROC

PROC parse_numbers()
	parse 1,"007.50";
	parse 2,"+12";
	parse 3,".5";
	parse 4,"1E3";
	parse 5,"-2.5e-1";
	parse 6,"abc";
	parse 7,"12abc";
	parse 8,"TRUE";
	parse 9,"1;2";
ENDPROC

PROC parse_values()
	okFlags{10}:=StrToVal("[1.5,-2,1E1]",p);
	okFlags{11}:=StrToVal("TRUE",b);
	okFlags{12}:=StrToVal("[1,2",p);
ENDPROC

PROC search()
	found{1}:=StrMatch("abcabc",2,"abc");
	found{2}:=StrMatch("abcabc",1,"x");
	found{3}:=StrFind("key=value",1,"=:");
	found{4}:=StrFind("12 345",1,STR_DIGIT\NotInSet);
	found{5}:=StrLen("\0D\0A");
	IF StrMemb("robot",2,"aeiou") found{6}:=1;
	IF StrOrder("abc","abd",STR_LOWER) found{7}:=1;
	IF "abc"<>"ABC" AND "abc"="ab"+"c" found{8}:=1;
ENDPROC

! grows by ten characters until the controller refuses
PROC limit()
	VAR string s:="";
	FOR i FROM 1 TO 9 DO
		s:=s+"123456789"+ByteToStr(64+i\Char);
	ENDFOR
	longest:=s;
ERROR
	IF ERRNO=ERR_STRTOOLNG THEN
		Incr tooLong;
		TRYNEXT;
	ENDIF
ENDPROC
ENDMODULE
