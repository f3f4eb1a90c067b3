/* The library of a pythonfmu FMU: takes FMI's calls, mends them where pythonfmu's wrapper would fall, and hands them on.

   What the wrapper does with them by itself: errors that a host can mend are fatal; messages of its own have no category; of a URI it
   understands "file://" and "%20"; NULL and texts that are no UTF-8 crash it; a state that is saved over another one, or freed, is
   leaked, or left to be used again; of a buffer it reads as much as the host has room for.  No rule of the model is here. */
#define _GNU_SOURCE
#include <ctype.h>
#include <dlfcn.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include "launcher.h"

#include "log.h"

typedef struct {
    Log log;
    fmi2CallbackFunctions call; /* what pythonfmu gets; it keeps the pointer */
    fmi2Component inner;
    char *name;
    int told; /* whether the slave has said what is wrong in this call */
    int stepped;
} Launched;

#define FMI_CALLS(X)                                                                                                                      \
    X(Instantiate) X(FreeInstance) X(SetupExperiment) X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset)          \
    X(GetReal) X(GetInteger) X(GetBoolean) X(GetString) X(SetReal) X(SetInteger) X(SetBoolean) X(SetString) X(GetFMUstate)                \
    X(SetFMUstate) X(FreeFMUstate) X(SerializedFMUstateSize) X(SerializeFMUstate) X(DeSerializeFMUstate) X(DoStep) X(GetRealStatus)

static struct {
    void *library;
#define MEMBER(Call) fmi2##Call##TYPE *Call;
    FMI_CALLS(MEMBER)
} python;

/* -- messages */

static void from_slave(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String text, ...)
{
    Launched *l = environment;
    int own = 0; /* the slave's own messages have a category, and are safe as formats */
    (void)name;
    for (int k = 0; category && k < N_CATEGORIES; k++)
        own |= strcmp(category, log_categories[k]) == 0;
    if (own) {
        l->told |= status == fmi2Error;
        pass_on(&l->log, status, text);
    } else if (!l->told) {
        const char *line = strchr(text, '\n'); /* before it: the wrapper's function */
        say(&l->log, status == fmi2Fatal ? fmi2Error : status, "%s", line && line[1] ? line + 1 : text);
    }
}

/* What the slave refuses, a host can mend: pythonfmu's wrapper has let go of nothing that the slave did not hold fast. */
static fmi2Status mended(fmi2Status status) { return status == fmi2Fatal ? fmi2Error : status; }

/* -- texts and places */

/* Length of the UTF-8 character at `at`; 0 where there is none. */
static size_t utf8(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    size_t n = b[0] < 0x80 ? 1 : b[0] >= 0xc2 && b[0] < 0xe0 ? 2 : b[0] >= 0xe0 && b[0] < 0xf0 ? 3 : b[0] >= 0xf0 && b[0] < 0xf5 ? 4 : 0;
    for (size_t k = 1; k < n; k++)
        if ((b[k] & 0xc0) != 0x80)
            return 0;
    if ((b[0] == 0xe0 && b[1] < 0xa0) || (b[0] == 0xed && b[1] > 0x9f) || (b[0] == 0xf0 && b[1] < 0x90) || (b[0] == 0xf4 && b[1] > 0x8f))
        return 0;
    return n;
}

/* A copy in which every byte that is no UTF-8 is a question mark. */
static char *as_utf8(const char *text)
{
    char *copy = strdup(text ? text : "");
    for (char *at = copy; at && *at;) {
        size_t n = utf8(at);
        if (n == 0)
            *at = '?';
        at += n ? n : 1;
    }
    return copy;
}

static int is_utf8(const char *text)
{
    for (size_t n; *text; text += n)
        if ((n = utf8(text)) == 0)
            return 0;
    return 1;
}

static int hexadecimal(char digit) { return isdigit((unsigned char)digit) ? digit - '0' : tolower((unsigned char)digit) - 'a' + 10; }

/* The path in a URI file:/path, file:///path or file://host/path, or a plain path, without a slash at its end. */
static char *path_of(const char *uri)
{
    char *path = strdup(uri ? uri : ""), *to = path;
    if (!path)
        return NULL;
    if (strncasecmp(path, "file:", 5) == 0) {
        const char *from = path + 5;
        if (strncmp(from, "//", 2) == 0) {
            const char *root = strchr(from + 2, '/');
            from = root ? root : from + 2;
        }
        for (; *from; from++)
            if (*from == '%' && isxdigit((unsigned char)from[1]) && isxdigit((unsigned char)from[2])) {
                *to++ = (char)(16 * hexadecimal(from[1]) + hexadecimal(from[2]));
                from += 2;
            } else
                *to++ = *from;
        *to = 0;
    }
    for (size_t n = strlen(path); n > 1 && path[n - 1] == '/'; n--)
        path[n - 1] = 0;
    return path;
}

static int holds_the_slave(const char *folder)
{
    char file[4096];
    int n = snprintf(file, sizeof file, "%s/slavemodule.txt", folder);
    return *folder && n < (int)sizeof file && access(file, R_OK) == 0;
}

/* `up` folders above this library, and `below` from there */
static void beside(int up, const char *below, char path[4096])
{
    Dl_info here = {0};
    char real[4096] = "";
    if (dladdr((void *)beside, &here) && here.dli_fname && strlen(here.dli_fname) < sizeof real && !realpath(here.dli_fname, real))
        snprintf(real, sizeof real, "%s", here.dli_fname);
    for (int k = 0; k < up; k++) {
        char *slash = strrchr(real, '/');
        if (slash)
            *slash = 0;
    }
    if (snprintf(path, 4096, "%s/%s", real, below) >= 4096)
        *path = 0;
}

/* Where the slave lies: as the host says, or where this library was unzipped.  NULL and a message where it is not to be found. */
static char *find_resources(const Log *log, const char *uri)
{
    char own[4096], *path = path_of(uri);
    beside(3, "resources", own);
    if (path && !holds_the_slave(path) && holds_the_slave(own)) {
        free(path);
        path = strdup(own);
    }
    const char *wrong = !path || !holds_the_slave(path) ? "the folder resources of the unzipped FMU. Unzip it, and give the URI of that folder."
        : !is_utf8(path)                                ? "UTF-8. Unzip the FMU into another folder."
        : strstr(path, "%20")                           ? "without %20 in a name. Unzip the FMU into another folder."
                                                        : NULL;
    if (wrong) {
        char *shown = as_utf8(uri);
        say(log, fmi2Error, "resource location = '%.500s': must be %s", shown ? shown : "", wrong);
        free(shown);
        free(path);
        return NULL;
    }
    return path;
}

/* -- Python */

static int no_python(const Log *log) /* 0: there is one, and it can run the slave */
{
    for (int minor = 20; minor >= 11 && !dlsym(RTLD_DEFAULT, "Py_GetVersion"); minor--) {
        char name[40];
        snprintf(name, sizeof name, "libpython3.%d.so.1.0", minor);
        dlopen(name, RTLD_NOW | RTLD_GLOBAL);
    }
    void *symbol = dlsym(RTLD_DEFAULT, "Py_GetVersion");
    const char *(*version)(void);
    memcpy(&version, &symbol, sizeof version);
    if (!symbol) {
        say(log, fmi2Error, "libpython: must be found by this host. Put the folder of libpython3.11.so.1.0 or newer into LD_LIBRARY_PATH, "
                            "or use the native FMU.");
        return 1;
    }
    int major = 0, minor = 0;
    if (sscanf(version(), "%d.%d", &major, &minor) != 2 || major != 3 || minor < 11) {
        say(log, fmi2Error, "Python = %d.%d: must be 3.11 or newer. Run this host with such a Python, or use the native FMU.", major, minor);
        return 1;
    }
    return 0;
}

static void (*end_python)(void);

static void at_exit(void) { end_python(); }

/* Where pythonfmu's wrapper is going to start Python itself: it stays until the host ends, for numpy cannot be started twice in a
   process; and it ends before the wrapper, which otherwise ends it twice, comes to do so. */
static void start_no_second_python(void *library)
{
    void *running = dlsym(RTLD_DEFAULT, "Py_IsInitialized"), *end = library ? dlsym(library, "finalizePythonInterpreter") : NULL;
    int (*is_running)(void);
    Dl_info here = {0};
    memcpy(&is_running, &running, sizeof running);
    if (!running || is_running() || !end || !dladdr((void *)at_exit, &here))
        return;
    memcpy(&end_python, &end, sizeof end);
    dlopen(here.dli_fname, RTLD_NOW | RTLD_NODELETE);
    atexit(at_exit);
}

static int not_loaded(const Log *log) /* 0: pythonfmu's library is at hand */
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&lock);
    if (!python.library && no_python(log) == 0) {
        char path[4096];
        beside(1, INNER_LIBRARY, path);
        void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        int missing = !library;
        if (!library)
            say(log, fmi2Error, "%s: must be loadable (%s). Unzip the FMU again.", INNER_LIBRARY, dlerror());
        start_no_second_python(library);
#define FOUND(Call)                                                             \
    {                                                                           \
        void *symbol = library ? dlsym(library, "fmi2" #Call) : NULL;           \
        missing |= !symbol;                                                     \
        memcpy(&python.Call, &symbol, sizeof symbol);                           \
    }
        FMI_CALLS(FOUND)
        python.library = missing ? NULL : library;
    }
    pthread_mutex_unlock(&lock);
    return !python.library;
}

__attribute__((destructor)) static void unload(void)
{
    if (python.library && !end_python)
        dlclose(python.library);
}

/* -- life of an instance */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String uri, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    if (!functions)
        return NULL;
    Launched *l = calloc(1, sizeof *l);
    char *own = as_utf8(name), *resources = NULL;
    if (!l || !own)
        goto none;
    l->name = own;
    l->log = (Log){.logger = functions->logger, .environment = functions->componentEnvironment, .name = own};
    choose_categories(&l->log, logging != fmi2False, 1);
    const char *wrong = !*own ? "instance name: must not be empty. Give the instance a name." : NULL;
    if (type != fmi2CoSimulation)
        wrong = "type: must be fmi2CoSimulation. This FMU is no model exchange.";
    if (!guid || strcmp(guid, MODEL_GUID) != 0)
        wrong = "GUID: must be " MODEL_GUID ". The library and modelDescription.xml do not belong together.";
    if (wrong) {
        say(&l->log, fmi2Error, "%s", wrong);
        goto none;
    }
    resources = find_resources(&l->log, uri);
    if (!resources || not_loaded(&l->log))
        goto none;
    l->call = (fmi2CallbackFunctions){from_slave, functions->allocateMemory, functions->freeMemory, functions->stepFinished, l};
    l->inner = python.Instantiate(own, type, guid, resources, &l->call, visible, fmi2True);
    if (!l->inner)
        goto none;
    free(resources);
    return l;
none:
    free(resources);
    free(own);
    free(l);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c)
{
    Launched *l = c;
    if (!l)
        return;
    python.FreeInstance(l->inner);
    free(l->name);
    free(l);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    return c ? set_debug_logging(&((Launched *)c)->log, on, n, categories) : fmi2Error;
}

/* Hands a call on, or refuses it where `bad`. */
#define HAND_ON(bad, text, call)                     \
    Launched *l = c;                                 \
    if (!l)                                          \
        return fmi2Error;                            \
    if (bad)                                         \
        return say(&l->log, fmi2Error, "%s", text);  \
    l->told = 0;                                     \
    return mended(python.call)

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean with_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean with_stop,
                               fmi2Real stop)
{
    HAND_ON(0, "", SetupExperiment(l->inner, with_tolerance, tolerance, start, with_stop, stop));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { HAND_ON(0, "", EnterInitializationMode(l->inner)); }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { HAND_ON(0, "", ExitInitializationMode(l->inner)); }
fmi2Status fmi2Terminate(fmi2Component c) { HAND_ON(0, "", Terminate(l->inner)); }

fmi2Status fmi2Reset(fmi2Component c)
{
    Launched *l = c;
    if (!l)
        return fmi2Error;
    l->told = l->stepped = 0;
    return python.Reset(l->inner); /* where this is fatal, there is no slave any more */
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean no_return)
{
    Launched *l = c;
    if (!l)
        return fmi2Error;
    l->told = 0;
    fmi2Status status = mended(python.DoStep(l->inner, now, step, no_return));
    l->stepped |= status == fmi2OK;
    return status;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    Launched *l = c;
    return l ? say(&l->log, fmi2Error, "step: must not be cancelled: it is never asynchronous. Wait for fmi2DoStep.") : fmi2Error;
}

/* -- values */

#define ALL_GIVEN "value references and values: must be given. Pass as many as there are."
#define VALUES(Call, type)                                                                     \
    fmi2Status fmi2##Call(fmi2Component c, const fmi2ValueReference vr[], size_t n, type v[])   \
    {                                                                                          \
        HAND_ON(n > 0 && (!vr || !v), ALL_GIVEN, Call(l->inner, vr, n, v));                    \
    }
VALUES(GetReal, fmi2Real)
VALUES(GetInteger, fmi2Integer)
VALUES(GetBoolean, fmi2Boolean)
VALUES(GetString, fmi2String)
VALUES(SetReal, const fmi2Real)
VALUES(SetInteger, const fmi2Integer)
VALUES(SetBoolean, const fmi2Boolean)

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String v[])
{
    int bad = 0;
    for (size_t k = 0; vr && v && k < n; k++)
        bad |= v[k] && !is_utf8(v[k]);
    if (c && bad)
        return say(&((Launched *)c)->log, fmi2Error, "value: must be UTF-8. Give it in that encoding.");
    HAND_ON(n > 0 && (!vr || !v), ALL_GIVEN, SetString(l->inner, vr, n, v));
}

/* -- complete state */

#define SAVED "saved state: must not be empty. Save one first."

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Launched *l = c;
    if (!l)
        return fmi2Error;
    if (state && *state)
        python.FreeFMUstate(l->inner, state);
    if (state)
        *state = NULL;
    return fmi2OK;
}

/* The state that a host gets takes the place of the one that it had there. */
static fmi2Status put(Launched *l, fmi2Status status, fmi2FMUstate made, fmi2FMUstate *state)
{
    if (mended(status) != fmi2OK)
        return mended(status);
    fmi2FreeFMUstate(l, state);
    *state = made;
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    Launched *l = c;
    fmi2FMUstate made = NULL;
    if (!l)
        return fmi2Error;
    if (!state)
        return say(&l->log, fmi2Error, "place of the saved state: must be given. Pass the address of an fmi2FMUstate.");
    l->told = 0;
    fmi2Status status = python.GetFMUstate(l->inner, &made);
    return put(l, status, made, state);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    if (c)
        ((Launched *)c)->stepped = 0;
    HAND_ON(!state, SAVED, SetFMUstate(l->inner, state));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    HAND_ON(!state || !size, SAVED, SerializedFMUstateSize(l->inner, state, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte to[], size_t size)
{
    size_t wanted = 0;
    if (fmi2SerializedFMUstateSize(c, state, &wanted) != fmi2OK)
        return fmi2Error;
    Launched *l = c;
    if (size < wanted || !to)
        return say(&l->log, fmi2Error, "room for the saved state = %zu bytes: must be at least %zu. Ask fmi2SerializedFMUstateSize.",
                   to ? size : 0, wanted);
    l->told = 0;
    return mended(python.SerializeFMUstate(l->inner, state, to, wanted));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte from[], size_t size, fmi2FMUstate *state)
{
    Launched *l = c;
    fmi2FMUstate made = NULL;
    if (!l)
        return fmi2Error;
    if (!from || !state)
        return say(&l->log, fmi2Error, "saved state: must be given, and a place for it. Pass what fmi2SerializeFMUstate wrote.");
    l->told = 0;
    fmi2Status status = python.DeSerializeFMUstate(l->inner, from, size, &made);
    return put(l, status, made, state);
}

/* -- status, and what the capability flags leave out */

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    Launched *l = c;
    if (!l || !value)
        return fmi2Error;
    return kind == fmi2LastSuccessfulTime && l->stepped ? python.GetRealStatus(l->inner, kind, value) : fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!c || !value)
        return fmi2Error;
    *value = fmi2False;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

static const Log *log_of(fmi2Component c) { return &((const Launched *)c)->log; }

#include "absent.h"
