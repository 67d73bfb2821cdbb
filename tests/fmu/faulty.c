/* A library with the functions of FMI that do nothing: the rules of behaviour that it breaks are
 * all. */
#define NOTHING(name) \
  int name(void) { return 0; }

const char* fmi2GetTypesPlatform(void) { return "other"; }
const char* fmi2GetVersion(void) { return "1.0"; }
void* fmi2Instantiate(const char* name) { return (void*)name; }
void fmi2FreeInstance(void* instance) { (void)instance; }

NOTHING(fmi2SetDebugLogging)
NOTHING(fmi2SetupExperiment)
NOTHING(fmi2EnterInitializationMode)
NOTHING(fmi2ExitInitializationMode)
NOTHING(fmi2Terminate)
NOTHING(fmi2Reset)
NOTHING(fmi2GetReal)
NOTHING(fmi2GetInteger)
NOTHING(fmi2GetBoolean)
NOTHING(fmi2GetString)
NOTHING(fmi2SetReal)
NOTHING(fmi2SetInteger)
NOTHING(fmi2SetBoolean)
NOTHING(fmi2SetString)
NOTHING(fmi2GetFMUstate)
NOTHING(fmi2SetFMUstate)
NOTHING(fmi2FreeFMUstate)
NOTHING(fmi2SerializedFMUstateSize)
NOTHING(fmi2SerializeFMUstate)
NOTHING(fmi2DeSerializeFMUstate)
NOTHING(fmi2GetDirectionalDerivative)
NOTHING(fmi2SetRealInputDerivatives)
NOTHING(fmi2GetRealOutputDerivatives)
NOTHING(fmi2DoStep)
NOTHING(fmi2CancelStep)
NOTHING(fmi2GetStatus)
NOTHING(fmi2GetRealStatus)
NOTHING(fmi2GetIntegerStatus)
NOTHING(fmi2GetBooleanStatus)
NOTHING(fmi2GetStringStatus)
