MODULE ToolBox
	!***********************************************************************
	! Boîte à outils de l'atelier : un peu de tout, essayé au démarrage
	! auteur : M. Lefèvre      dernière modification : un vendredi
	!***********************************************************************
	ALIAS num niveau;
	RECORD mesure
		niveau brut;
		string unite;
	ENDRECORD

	CONST num NB:=3;
	PERS num cycles:=0;
	PERS string journal:="";
	PERS num resultats{12}:=[0,0,0,0,0,0,0,0,0,0,0,0];
	PERS bool drapeaux{8}:=[FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE,FALSE];
	VAR num compteur:=0;
	VAR num cote1:=10;
	VAR num cote2:=20;
	VAR num cote3:=30;
	VAR mesure mesures{NB};
	VAR num tours:=0;
	PERS num total:=5;
	VAR iodev fichier;

	PROC main()
		VAR num locale:=0;
		! recommence deux fois ; seules les données locales repartent de zéro
		compteur:=compteur+1;
		locale:=locale+1;
		cycles:=cycles+1;
		resultats{1}:=locale;
		IF cycles<3 ExitCycle;

		parNom;
		recursif;
		boucles;
		masque;
		nombres;
		chargement;
		lecture;
		systeme;
		TPWrite journal;
		EXIT;
	ENDPROC

	! données trouvées par leur nom
	PROC parNom()
		VAR num valeur;
		FOR i FROM 1 TO NB DO
			GetDataVal "cote"+NumToStr(i,0),valeur;
			resultats{2}:=resultats{2}*100+valeur;
			SetDataVal "cote"+ValToStr(i),valeur+1;
		ENDFOR
		resultats{3}:=cote1+cote2+cote3;
		FOR i FROM 1 TO NB DO
			mesures{i}:=[i*i,"mm"];
		ENDFOR
		mesures{2}.unite:="deg";
		noter ArgEcho(mesures{2}.unite);
	ENDPROC

	FUNC string ArgEcho(string texte)
		RETURN "<"+texte+">";
	ENDFUNC

	PROC recursif()
		resultats{4}:=factorielle(6);
		hanoi 5,"A","B","C";
		resultats{5}:=tours;
	ENDPROC

	FUNC num factorielle(num n)
		IF n<=1 RETURN 1;
		RETURN n*factorielle(n-1);
	ENDFUNC

	PROC hanoi(num n,string de,string vers,string via)
		IF n=0 RETURN;
		hanoi n-1,de,via,vers;
		tours:=tours+1;
		hanoi n-1,via,vers,de;
	ENDPROC

	PROC boucles()
		VAR num fin:=3;
		VAR num n:=0;
		! les bornes ne sont lues qu'une fois
		FOR i FROM 1 TO fin DO
			fin:=10;
			n:=n+1;
		ENDFOR
		FOR x FROM 0 TO 1 STEP .25 DO
			n:=n+10;
		ENDFOR
		FOR i FROM 2 TO -2 STEP -2 DO
			n:=n+100;
		ENDFOR
		resultats{6}:=n;
	ENDPROC

	! une locale cache la donnée du module, un paramètre est une copie
	PROC masque()
		VAR num total:=1;
		VAR num a{3}:=[1,2,3];
		VAR num b{3};
		total:=total+1;
		b:=a;
		a{1}:=99;
		resultats{7}:=total*100+b{1};
		copie b{2};
		resultats{8}:=b{2};
		reference b{3};
		resultats{8}:=resultats{8}*100+b{3};
	ENDPROC

	PROC copie(num valeur)
		valeur:=valeur+50;
	ENDPROC

	PROC reference(VAR num valeur)
		valeur:=valeur+50;
	ENDPROC

	PROC nombres()
		resultats{9}:=Sqrt(16)+Pow(2,3)+Abs(-1)+ATan2(1,1)+Round(Sin(30)*10)+Trunc(7/2);
		resultats{10}:=ACos(0)+ASin(1)+Round(Exp(0))+(-7) MOD 4*0;
		drapeaux{1}:=1<2 AND "a"="a" OR FALSE;
		drapeaux{2}:=(TRUE=FALSE)=FALSE;
		drapeaux{3}:=2+3*2=8;
	ENDPROC

	! un module du disque, chargé, appelé, rendu
	PROC chargement()
		Load\Dynamic,"HOME:"\File:="piece.mod";
		%"PieceChargee"%;
		UnLoad "HOME:"\File:="piece.mod";
		%"PieceChargee"%;
	ERROR
		IF ERRNO=ERR_REFUNKPRC THEN
			drapeaux{4}:=TRUE;
			TRYNEXT;
		ENDIF
		RAISE;
	ENDPROC

	PROC lecture()
		Open "HOME:"\File:="nombres.txt",fichier\Read;
		resultats{11}:=ReadNum(fichier);
		resultats{11}:=resultats{11}+ReadNum(fichier);
		Rewind fichier;
		resultats{12}:=ReadNum(fichier);
		Close fichier;
	ENDPROC

	PROC systeme()
		drapeaux{5}:=OpMode()=OP_AUTO;
		drapeaux{6}:=RunMode()=RUN_CONT_CYCLE;
		drapeaux{7}:=GetTaskName()="T_ROB1";
		drapeaux{8}:=NOT IsStopMoveAct(\FromMoveTask);
	ENDPROC

	PROC noter(string texte)
		journal:=journal+texte+";";
	ENDPROC
ENDMODULE
