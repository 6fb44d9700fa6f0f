MODULE PalletCell
  !*****************************************************
  ! Cell 14 - boxes from the infeed to a two layer stack
  ! Rev 3: the slot table is 3-D now (layer, row, column)
  !*****************************************************
  CONST num nLayers:=2;
  CONST num nRows:=2;
  CONST num nCols:=2;
  CONST num nLayerHeight:=40;

  ! offsets of the slots in one layer, mm: row, column, [x y]
  CONST num nSlotXY{2,2,2}:=[[[0,0],[0,50]],[[60,0],[60,50]]];
  ! turn of the box about the tool, degrees
  CONST num nTurn{nRows,nCols}:=[[0,0],[0,30]];

  PERS num nPlaced{2,2,2}:=[[[0,0],[0,0]],[[0,0],[0,0]]];
  PERS num nTotal:=0;
  PERS bool bLayerFull{2}:=[FALSE,FALSE];

  PERS tooldata tVacuum:=[TRUE,[[0,0,160],[1,0,0,0]],[1.2,[0,0,60],[1,0,0,0],0,0,0]];
  PERS wobjdata wPallet:=[FALSE,TRUE,"",[[400,60,250],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PERS loaddata lBox:=[0.8,[0,0,20],[1,0,0,0],0,0,0];

  CONST robtarget pInfeed:=[[460,220,330],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pCorner:=[[0,0,0],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST jointtarget jHome:=[[20,0,10,0,60,20],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR robtarget pLastPlaced;

  PROC main()
    VAR num nLayer;
    initCell;
    FOR layer FROM 1 TO nLayers DO
      TPWrite "Layer "\Num:=layer;
      FOR row FROM 1 TO Dim(nPlaced,2) DO
        FOR col FROM 1 TO Dim(nPlaced,3) DO
          pickBox;
          placeBox layer,row,col;
        ENDFOR
      ENDFOR
      bLayerFull{layer}:=layerIsFull(layer);
    ENDFOR
    TPWrite "Stack done, boxes: "\Num:=nTotal;
    EXIT;
  ENDPROC

  PROC initCell()
    nTotal:=0;
    FOR i FROM 1 TO nLayers DO
      FOR j FROM 1 TO nRows DO
        FOR k FROM 1 TO nCols DO
          nPlaced{i,j,k}:=0;
        ENDFOR
      ENDFOR
      bLayerFull{i}:=FALSE;
    ENDFOR
    SetDO do1,0;
    ConfJ\Off;
    ConfL\Off;
    MoveAbsJ jHome\NoEOffs,v1500,fine,tVacuum;
  ENDPROC

  PROC pickBox()
    MoveJ Offs(pInfeed,0,0,60),v2000,z20,tVacuum;
    MoveL pInfeed,v1000,fine,tVacuum;
    SetDO do1,1;
    WaitTime 0.05;
    GripLoad lBox;
    MoveL RelTool(pInfeed,0,0,-60),v1000,z20,tVacuum;
  ENDPROC

  PROC placeBox(num layer,num row,num col)
    VAR robtarget pSlot;
    pSlot:=slotTarget(layer,row,col);
    MoveJ RelTool(pSlot,0,0,-80),v2000,z20,tVacuum\WObj:=wPallet;
    MoveL pSlot,v1000,fine,tVacuum\WObj:=wPallet;
    SetDO do1,0;
    GripLoad load0;
    pLastPlaced:=CRobT(\Tool:=tVacuum\WObj:=wPallet);
    nTotal:=nTotal+1;
    nPlaced{layer,row,col}:=nTotal;
    MoveL RelTool(pSlot,0,0,-80),v1000,z20,tVacuum\WObj:=wPallet;
    IF nTotal=nLayers*nRows*nCols MoveL RelTool(pSlot,0,0,-100),v500,fine,tVacuum\WObj:=wPallet;
  ENDPROC

  FUNC robtarget slotTarget(num layer,num row,num col)
    VAR robtarget p;
    p:=Offs(pCorner,nSlotXY{row,col,1},nSlotXY{row,col,2},(layer-1)*nLayerHeight);
    RETURN RelTool(p,0,0,0\Rz:=nTurn{row,col});
  ENDFUNC

  FUNC bool layerIsFull(num layer)
    FOR j FROM 1 TO nRows DO
      FOR k FROM 1 TO nCols DO
        IF nPlaced{layer,j,k}=0 RETURN FALSE;
      ENDFOR
    ENDFOR
    RETURN TRUE;
  ENDFUNC
ENDMODULE
