/* FMI 2.0 for co-simulation around the compiled kernels.  Nothing here knows a model: model.h, which is generated, holds the
   interface table, the rules and the kernels. */
#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#else
#include <time.h>
#endif

#include "component.h"
#include "values.h"
#include "state.h"

/* -- life of an instance */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    return c ? set_debug_logging(&((Instance *)c)->log, on, n, categories) : fmi2Error;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    Instance *m = c;
    if (!m)
        return fmi2Error;
    memset(&m->core, 0, sizeof m->core);
    m->told = 0;
    m->unused = 0;
    for (int vr = 0; vr < N_VARIABLES; vr++)
        m->core.values[vr] = variables[vr].start;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging)
{
    Instance caller = {.call = {NULL, NULL, NULL, NULL, NULL}};
    (void)resources, (void)visible; /* nothing is read from there */
    if (!functions)
        return NULL;
    caller.call = *functions;
    caller.log = (Log){.logger = functions->logger, .environment = functions->componentEnvironment, .name = name ? name : ""};
    choose_categories(&caller.log, logging != fmi2False, 1);
    const char *wrong = !name || !*name ? "instance name: must not be empty. Give the instance a name." : NULL;
    if (type != fmi2CoSimulation)
        wrong = "type: must be fmi2CoSimulation. This FMU is no model exchange.";
    if (!guid || strcmp(guid, MODEL_GUID) != 0)
        wrong = TOKEN ": must be " MODEL_GUID ". The library and modelDescription.xml do not belong together.";
    Instance *m = wrong ? NULL : take(&caller, sizeof *m);
    if (!m) {
        fail(&caller, "%s", wrong ? wrong : "memory: must be available. Close something.");
        return NULL;
    }
    *m = caller;
    m->name = take(m, strlen(name) + 1);
    if (!m->name) {
        give_back(&caller, m);
        return NULL;
    }
    strcpy(m->name, name);
    m->log.name = m->name;
    fmi2Reset(m);
    return m;
}

void fmi2FreeInstance(fmi2Component c)
{
    Instance *m = c;
    if (!m)
        return;
    give_back(m, m->state);
    give_back(m, m->name);
    give_back(m, m);
}

static fmi2Status expect(const Instance *m, Phase phase, const char *rule)
{
    if (!m)
        return fmi2Error;
    return m->core.phase == phase ? fmi2OK : fail(m, "instance = '%s': must be %s", phases[(int)m->core.phase], rule);
}

/* As Python shows a float. */
static double unsigned_nan(double value) { return isnan(value) ? fabs(value) : value; }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean with_tolerance, fmi2Real tolerance, fmi2Real start, fmi2Boolean with_stop,
                               fmi2Real stop)
{
    Instance *m = c;
    (void)with_tolerance, (void)tolerance; /* solver.tolerance says how steps are chosen */
    if (expect(m, INSTANTIATED, "new. Reset it first.") != fmi2OK)
        return fmi2Error;
    if (!isfinite(start))
        return fail(m, "start time = %.10g s: must be finite. Give the time at which the simulation starts.", unsigned_nan(start));
    if (with_stop && !(isfinite(stop) && stop >= start))
        return fail(m, "stop time = %.10g s: must be finite and >= the start time %.10g s. Give a later one, or none.", unsigned_nan(stop), start);
    m->core.start_time = m->core.last_time = start;
    m->core.has_stop = with_stop != fmi2False;
    m->core.stop_time = with_stop ? stop : 0.0;
    m->core.set_up = 1.0;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    Instance *m = c;
    if (expect(m, INSTANTIATED, "new. Reset it first.") != fmi2OK)
        return fmi2Error;
    if (m->core.set_up == 0.0)
        return fail(m, "experiment: must be set up before initialization. Call fmi2SetupExperiment first.");
    m->core.phase = INITIALIZING;
    m->core.outdated = 1.0;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    Instance *m = c;
    if (expect(m, INITIALIZING, "initializing. Enter the initialization mode first.") != fmi2OK || preview(m) != fmi2OK)
        return fmi2Error;
    m->core.phase = RUNNING;
    say(&m->log, fmi2OK, "%s simulates: %s", MODEL_NAME, active_effects(m));
    tell_doubts(m);
    return fmi2OK;
}

#ifdef _WIN32 /* the time that has passed: Windows counts a thread's own in ticks of 15.6 ms */
static double processor_time(void)
{
    LARGE_INTEGER count, per_second;
    QueryPerformanceCounter(&count), QueryPerformanceFrequency(&per_second);
    return (double)count.QuadPart / (double)per_second.QuadPart;
}
#else
static double processor_time(void)
{
    struct timespec now = {0};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
#endif

/* A step begins where the last one ended, and ends by the stop time, but for the rounding of a host's clock. */
static fmi2Status check_time(const Instance *m, double now, double step)
{
    double last = m->core.last_time, slack = STEP_SLACK * step + TIME_SLACK * (1.0 + fabs(last));
    if (fabs(now - last) > slack)
        return fail(m, "communication point = %.12g s: must be %.12g s, where the last step ended. Go on from there, or restore a state.", now, last);
    if (m->core.has_stop != 0.0 && now + step > m->core.stop_time + slack)
        return fail(m, "end of the step = %.12g s: must be <= %.12g s, the stop time. Shorten the step, or set up a later stop time.", now + step,
                    m->core.stop_time);
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean no_return)
{
    Instance *m = c;
    double outputs[N_OUTPUTS] = {0.0}, begun = processor_time();
    (void)no_return;
    if (expect(m, RUNNING, "initialized and running. Initialize, reset or restore it first.") != fmi2OK)
        return fmi2Error;
    if (!isfinite(now))
        return fail(m, "communication point = %.10g s: must be finite. Give the time at which the step begins.", unsigned_nan(now));
    if (!isfinite(step) || !(step > 0.0))
        return fail(m, "communication step = %.10g s: must be %s", unsigned_nan(step), STEP_TEXT);
    if (check_time(m, now, step) != fmi2OK)
        return fmi2Error;
    int64_t status = run(m, STEP, now, step, outputs);
    if (status != OK) {
        m->core.phase = status == TOO_FAST ? RUNNING : FAILED;
        return report(m, status, now, outputs[0]);
    }
    keep_outputs(m, outputs);
    m->core.last_time = now + step;
    m->core.values[CPU_TIME] += processor_time() - begun;
    tell_doubts(m);
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return c ? fail(c, "step: must not be cancelled: it is never asynchronous. Wait for fmi2DoStep.") : fmi2Error;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    Instance *m = c;
    if (!m)
        return fmi2Error;
    if (m->core.phase != RUNNING && m->core.phase != FAILED)
        return expect(m, RUNNING, "initialized and not terminated. Reset it or free it instead.");
    m->core.phase = m->core.phase == FAILED ? FAILED_AND_TERMINATED : TERMINATED;
    return fmi2OK;
}

/* -- status, and what the capability flags leave out */

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (!c || !value)
        return fmi2Error;
    *value = ((Instance *)c)->core.last_time;
    return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (!c || !value)
        return fmi2Error;
    *value = ((Instance *)c)->core.phase >= TERMINATED;
    return kind == fmi2Terminated ? fmi2OK : fmi2Discard;
}

static const Log *log_of(fmi2Component c) { return &((const Instance *)c)->log; }

#include "absent.h"
