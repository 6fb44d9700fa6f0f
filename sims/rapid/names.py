"""Names of ABB's that are known and not offered here, so that they can be refused by name.

A program that declares such a name itself means its own.
"""

__all__ = ["UNSUPPORTED", "UNSUPPORTED_TYPES", "why_unsupported"]

_FAMILIES = {
    "Externally Guided Motion": """
        EGMActJoint EGMActMove EGMActPose EGMGetId EGMGetState EGMMoveC EGMMoveL EGMReset
        EGMRunJoint EGMRunPose EGMSetupAI EGMSetupAO EGMSetupGI EGMSetupLTAPP EGMSetupUC EGMStop
        EGMStreamStart EGMStreamStop EGMWaitCond
    """,
    "MultiMove": """
        SyncMoveOn TasksInSync SyncMoveOff SyncMoveUndo IsSyncMoveOn
        MoveExtJSync ArcMoveExtJ SyncMoveGun
    """,
    "datagram sockets": """
        SocketSendTo SocketReceiveFrom
    """,
    "speeds and signals along a path": """
        TriggSpeed TriggRampAO TriggStopProc StepBwdPath PathLengthReset PathLengthStart
        PathLengthStop PathLengthGet SpeedLimAxis SpeedLimCheckPoint
    """,
    "cyclically evaluated conditions": """
        SetupCyclicBool RemoveCyclicBool RemoveAllCyclicBool IsCyclicBool GetNextCyclicBool
        GetNumberOfCyclicBool GetMaxNumberOfCyclicBool
    """,
    "external axes": """
        SearchExtJ MaxExtLinearSpeed MaxExtReorientSpeed CalcRotAxFrameZ CalcRotAxisFrame
        DefAccFrame HollowWristReset
    """,
    "lead-through and safety controllers": """
        SetLeadThrough IsLeadThrough SafetyControllerGetChecksum SafetyControllerGetSWVersion
        SafetyControllerGetUserChecksum SafetyControllerGetOpModePinCode
        SafetyControllerSyncRequest IsBrakeCheckActive CyclicBrakeCheck
    """,
    "what servo and system measure of themselves": """
        TestSignDefine TestSignRead TestSignReset SpyStart SpyStop GetTorqueMargin
        ResetTorqueMargin GetMotorTorque ReadMotor GetAxisDistance ResetAxisDistance
        GetAxisMoveTime ResetAxisMoveTime GetServiceInfo FricIdInit FricIdEvaluate
        FricIdSetFricLevels MotionProcessModeSet SoftElbow DitherAct DitherDeact
        GetModalPayLoadMode MaxRobReorientSpeed GetJointData
    """,
    "the operating system of a controller": """
        WarmStart WriteCfgData SaveCfgData ProgMemFree FSSize RobOS GetUASUserName GetTSPStatus
        IOBusStart IOBusState IOUnitState PackDNHeader SCWrite SiConnect SiClose SiGetCyclic
        SiSetCyclic ReadVarArr WriteVarArr PPMovedInManMode ResetPPMoved CheckProgRef
    """,
    "raising to and asking about callers": """
        RaiseToUser ArgName
    """,
    "independent axes": """
        IndAMove IndCMove IndDMove IndRMove IndReset IndInpos IndSpeed
    """,
    "world zones": """
        WZBoxDef WZCylDef WZDisable WZDOSet WZEnable WZFree WZHomeJointDef WZLimJointDef WZLimSup
        WZSphDef
    """,
    "conveyor tracking": """
        WaitWObj DropWObj ActConveyor CnvGenInstr CnvPredReach IndCnvAddObject IndCnvEnable
        IndCnvDisable IndCnvInit IndCnvReset UseConveyor
    """,
    "arc welding": """
        ArcL ArcLStart ArcLEnd ArcC ArcCStart ArcCEnd ArcL1 ArcC1 ArcLEnd1 ArcCEnd1 ArcKill
        ArcRefresh ArcCalcLStart ArcCalcCStart Arc_Off Arc_On SetWRamp
    """,
    "spot welding": """
        SpotL SpotJ SpotML SpotMJ SetForce CalibL CalibJ Calibrate OpenHighLift CloseHighLift
        IndGunMove IndGunMoveReset STClose STOpen STCalib STTune STTuneReset STIndGun
        STIndGunReset STIsCalib STIsClosed STIsIndGun STIsOpen STCalcForce STCalcTorque
        STIsServoTool
    """,
    "dispensing and painting": """
        DispL DispC PaintL PaintC SetBrush SetBrushFac UseBrushTab UseReachTab MoveLStep
    """,
    "calibration": """
        BElateral BullsEye BESetupToolJ BESetupWO BEUpdateTcp BERefPointer MToolTCPCalib
        MToolRotCalib SToolTCPCalib SToolRotCalib LoadId ManLoadIdProc ParIdRobValid ParIdPosValid
        SpcLoadId
    """,
    "force control": """
        FCAct FCDeact FCCalib FCPress1LStart FCPressL FCPressC FCPressEnd FCSpdChgAct
        FCSpdChgDeact FCRefForce FCRefLine FCRefMoveFrame FCRefRot FCRefSpiral FCRefStart
        FCRefStop FCRefTorque FCGetForce FCLoadID FCCondForce FCCondPos FCCondTorque
        FCCondWaitWhile FCSetMaxForceChange FCSupvForce FCSupvPos FCIsForceMode FCGetProcessData
    """,
    "integrated vision": """
        CamFlush CamGetExposure CamGetLoadedJob CamGetName CamGetParameter CamGetResult CamLoadJob
        CamNumberOfResults CamReqImage CamSetExposure CamSetParameter CamSetProgramMode
        CamSetRunMode CamStartLoadJob CamStartSetParameter CamWaitLoadJob CamWaitSetParameter
        CamGetMode
    """,
    "path corrections and sensors": """
        CorrClear CorrCon CorrDiscon CorrRead CorrWrite SenDevice ReadBlock ReadVar WriteBlock
        WriteVar IVarValue SupSyncSensorOn SupSyncSensorOff SyncToSensor DropSensor
        PrxActivAndStoreRecord PrxActivRecord PrxDbgStoreRecord PrxDeactRecord PrxGetMaxRecordpos
        PrxResetPos
        PrxResetRecords PrxSetPosOffset PrxSetRecordSampleTime PrxSetSyncalarm PrxStartRecord
        PrxStopRecord PrxStoreRecord PrxUseFileRecord WaitSensor
    """,
    "path recovery": """
        PathRecValidBwd PathRecValidFwd
    """,
    "contact, search and servo tuning": """
        ContactL CapL CapC CapLATrSetup CapAPTrSetup ForceL TuneServo TuneReset MechUnitLoad
    """,
    "dialogues of FlexPendant pictures": """
        UIListView UIClientExist UIAlphaEntry UINumTune UIDnumEntry UIDnumTune
        UIMsgWrite UIMsgWriteAbort UIShow
    """,
}

_TYPE_FAMILIES = {
    "arc welding": """
        arcdata seamdata weavedata welddata trackdata heatdata adaptdata seamtrackdata
    """,
    "spot welding": """
        spotdata gundata forcedata simdata spotmultdata smeqdata equipdata toolchgdata
    """,
    "dispensing and painting": """
        beaddata brushdata
    """,
    "force control": """
        fcboxvol fcspeedvector fcforcevector fccondstatus fcplane fcframe fclindir fcrotdir
        fcsphvol fccylvol fcxyznum fcprocessdata fcspdchgtunetype
    """,
    "MultiMove": """
        syncdata
    """,
    "contact, search and servo tuning": """
        capdata caplatrackdata capaptrreferencedata capspeeddata capweavedata capstopmode
        restartblkdata supervtimeouts weavestartdata flypointdata
    """,
}


def _by_name(families: dict[str, str]) -> dict[str, str]:
    return {name.lower(): family for family, names in families.items() for name in names.split()}


UNSUPPORTED = _by_name(_FAMILIES)
UNSUPPORTED_TYPES = _by_name(_TYPE_FAMILIES)


def why_unsupported(name: str) -> str | None:
    """Return a sentence for an instruction, function or type that is refused; None otherwise."""
    low = name.lower()
    family = UNSUPPORTED.get(low) or UNSUPPORTED_TYPES.get(low)
    if family is None:
        return None
    return f"{name} belongs to {family}, which this controller does not offer: leave it out"
