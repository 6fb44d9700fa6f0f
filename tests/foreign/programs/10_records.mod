MODULE mod_records
! ---------------------------------------------------------------------------
! part store with nested records;  opts = optional arguments
! ---------------------------------------------------------------------------
RECORD dims_t
  num w;
  num h;
ENDRECORD

RECORD part_t
  string id;
  dims_t dims;
  pos where;
  bool ok;
ENDRECORD

CONST num N_PARTS := 3;
CONST num FIRST_FOUR{4} := [1,2,3,4];
CONST dims_t DIMS_STD := [20,10];
VAR num base_x := 100;

VAR part_t parts{N_PARTS};
VAR part_t spare;
VAR part_t grid{2,2};
VAR num areas{N_PARTS};
PERS num sums{4} := [0,0,0,0];
PERS string calls{6} := ["","","","","",""];
VAR num nCalls := 0;
PERS pos lastPos := [0,0,0];
PERS robtarget pBuilt := [[0,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
PERS bool same := FALSE;
PERS num totalArea := 0;

PROC main()
  VAR dims_t d;
  VAR part_t copy;
  nCalls := 0;

  ! literals, constants and variables in one aggregate
  d := [5, 2 + 1];
  parts{1} := ["A", DIMS_STD, [base_x, 2 * base_x, 0], TRUE];
  parts{2} := ["B", d, [base_x + 1, -1, .5], FALSE];
  parts{3} := parts{1};
  parts{3}.id := "C";
  parts{3}.dims.w := parts{3}.dims.w * 2;
  parts{3}.where.z := parts{2}.where.z + 1;

  ! a copy is a copy
  copy := parts{2};
  copy.dims.h := 1000;
  same := parts{2} = copy;

  grid{2,1} := parts{3};
  grid{2,1}.where := [1, 2, 3];
  lastPos := grid{2,1}.where;

  totalArea := area_of(parts);
  collect areas, parts;
  sums{1} := sum_of(areas);
  sums{2} := sum_of(FIRST_FOUR);
  scale areas, 2;
  sums{3} := sum_of(areas);
  sums{4} := Dim(grid, 1) * 10 + Dim(grid, 2);

  report;
  report \Title := "t";
  report \Title := "t" \Verbose;
  outer \Title := "o";
  outer \Verbose;
  outer \Terse, \Title := "z";

  pBuilt := build([lastPos.x + 400, 100, 300] \rot := [0, 0, 1, 0]);
  EXIT;
ENDPROC

FUNC num area(dims_t d)
  RETURN d.w * d.h;
ENDFUNC

FUNC num area_of(part_t list{*})
  VAR num total;
  FOR i FROM 1 TO Dim(list, 1) DO
    total := total + area(list{i}.dims);
  ENDFOR
  RETURN total;
ENDFUNC

PROC collect(VAR num out{*}, part_t list{*})
  FOR i FROM Dim(list, 1) TO 1 DO
    out{i} := area(list{i}.dims);
  ENDFOR
ENDPROC

FUNC num sum_of(num list{*})
  VAR num total := 0;
  FOR i FROM 1 TO Dim(list, 1) STEP 1 DO
    total := total + list{i};
  ENDFOR
  RETURN total;
ENDFUNC

PROC scale(INOUT num list{*}, num factor)
  FOR i FROM 1 TO Dim(list, 1) DO
    list{i} := list{i} * factor;
  ENDFOR
ENDPROC

PROC note(string s)
  Incr nCalls;
  calls{nCalls} := s;
ENDPROC

PROC report(\string Title, \switch Verbose | switch Terse)
  VAR string s := "";
  IF Present(Title) s := s + Title; 
  IF Present(Verbose) THEN
    s := s + "+v";
  ELSEIF Present(Terse) THEN
    s := s + "+q";
  ENDIF
  IF s = "" s := "none";
  note s;
ENDPROC

PROC outer(\switch Verbose | switch Terse, \string Title)
  ! what was not given here is not given there either
  report \Title?Title \Verbose?Verbose \Terse?Terse;
ENDPROC

FUNC robtarget build(pos p \orient rot | pose frame)
  VAR robtarget t := [[0,0,0],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  t.trans := p;
  IF Present(rot) t.rot := rot;
  RETURN t;
ENDFUNC
ENDMODULE
