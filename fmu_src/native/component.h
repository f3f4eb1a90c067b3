/* One instance: its errors, its memory, and the way from parameter values to the kernels.  No FMI calls; included once, by fmu.c.
   Everything that an instance is lies in Core and in the kernels' state vector. */
#include <stdlib.h>

#include "model.h"

#include "log.h"

#ifndef FMI /* the words of this version of FMI in what a host is told; fmi3.c has those of FMI 3.0 */
#define FMI "fmi2"
#define FMU_STATE "FMUstate"
#define TOKEN "GUID"
#define REAL "Real"
#define INTEGER "Integer"
#endif

enum { QUANTITIES = 4, N_PRESENCES = sizeof presences / sizeof *presences }; /* of a point of the shape: x, y, z and tension */

typedef enum { INSTANTIATED, INITIALIZING, RUNNING, FAILED, TERMINATED, FAILED_AND_TERMINATED } Phase;
static const char *const phases[] = {"instantiated", "initializing", "running", "failed", "terminated", "failed and terminated"};

typedef struct {
    double values[N_VARIABLES]; /* of every kind; a String's place is empty */
    double start_time, stop_time, last_time;
    double phase, outdated, initialized, set_up, has_stop, shaped; /* shaped: the shape is that of the last step */
} Core;

typedef struct {
    fmi2CallbackFunctions call;
    Log log;
    char *name;
    Core core;
    int variant;
    double numbers[N_NUMBERS], present[N_PARTS];
    double level[3], wave[OF_A_WAVE];
    int64_t n_state, n_work;
    double *state, *work;
    char active[1024];
    unsigned told; /* a bit for each kind of doubt */
    int unused; /* whether a derivative that nothing follows has been told */
} Instance;

/* -- errors and memory */

static fmi2Status fail(const Instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(&m->log, fmi2Error, format, arguments);
    va_end(arguments);
    return fmi2Error;
}

/* "name = value unit": how every text about a value begins */
static const char *shown(int vr, double value, char text[200])
{
    const Variable *v = &variables[vr];
    char number[40];
    snprintf(number, sizeof number, v->kind == 'R' ? "%.10g" : "%.0f", isnan(value) ? fabs(value) : value);
    const char *is = v->kind == 'B' ? (value != 0.0 ? "True" : "False") : number;
    snprintf(text, 200, "%s = %s%s%s", v->name, is, *v->unit ? " " : "", v->unit);
    return text;
}

static fmi2Status refuse(const Instance *m, int vr, double value, const char *rule)
{
    char text[200];
    return fail(m, "%s: must be %s", shown(vr, value, text), rule);
}

static void *take(const Instance *m, size_t size)
{
    void *memory = m->call.allocateMemory && m->call.freeMemory ? m->call.allocateMemory(1, size) : malloc(size);
    return memory ? memset(memory, 0, size) : NULL;
}

static void give_back(const Instance *m, void *memory)
{
    if (memory)
        (m->call.allocateMemory && m->call.freeMemory ? m->call.freeMemory : free)(memory);
}

/* -- from parameters to kernels */

static int variable_of(const Literal *l) { return l->variable >= CHANGED ? l->variable - CHANGED : l->variable; }

static int true_of(const Literal *l, double value)
{
    const Variable *v = &variables[variable_of(l)];
    int differs = l->variable >= CHANGED ? value != v->usual : v->angle ? fabs(sin(value)) > 1e-9 : value != 0.0;
    return differs == l->nonzero;
}

static int holds(const Core *core, const Condition *condition)
{
    int all = condition->count >= 0;
    for (int k = 0; k < condition->count; k++)
        all &= true_of(&condition->literals[k], core->values[variable_of(&condition->literals[k])]);
    return all;
}

static fmi2Status check_parameters(const Instance *m)
{
    for (int vr = 0; vr < N_VARIABLES; vr++) {
        const Variable *v = &variables[vr];
        double value = m->core.values[vr];
        if (v->causality != 'p')
            continue;
        if (*v->kept && value != v->start)
            return refuse(m, vr, value, v->kept);
        if (!isfinite(value))
            return refuse(m, vr, value, v->finite);
        if (value < v->least || value > v->most || (v->above && value == v->least) || (value > v->hole && value < v->gap))
            return refuse(m, vr, value, v->range);
    }
    for (size_t k = 0; k < sizeof refusals / sizeof *refusals; k++)
        if (holds(&m->core, &refusals[k].when))
            return refuse(m, refusals[k].variable, m->core.values[refusals[k].variable], refusals[k].text);
    return fmi2OK;
}

/* How many parts a variant lacks or has too many, and the first of them. */
static int apart(const char *variant, const double *present, int *first)
{
    int count = 0;
    for (int k = N_PARTS - 1; k >= 0; k--)
        if (variant[k] != EITHER && variant[k] != ALWAYS && variant[k] != (present[k] != 0.0 ? PRESENT : ABSENT))
            count++, *first = k;
    return count;
}

static int is_present(const Core *core, int part)
{
    int any = 0;
    for (int k = 0; k < N_PRESENCES; k++)
        any |= presences[k].part == part && holds(core, &presences[k].when);
    return any;
}

/* The value that a part is to be switched by: one that keeps it off, or the one that was changed to switch it on. */
static const Literal *switch_of(const Core *core, int part)
{
    const Literal *found = NULL, *first = NULL;
    int present = is_present(core, part);
    for (int j = N_PRESENCES - 1; j >= 0; j--) {
        const Condition *c = &presences[j].when;
        if (presences[j].part != part)
            continue;
        first = c->literals;
        for (int k = c->count - 1; k >= 0 && holds(core, c) == present; k--) {
            const Literal *l = &c->literals[k];
            int vr = variable_of(l);
            if (!true_of(l, core->values[vr]) || (present && !true_of(l, variables[vr].start)))
                found = l;
        }
    }
    return found ? found : first;
}

static fmi2Status choose_variant(Instance *m)
{
    char text[200];
    int fewest = N_PARTS + 1, part = 0;
    for (int k = 0; k < N_PARTS; k++)
        m->present[k] = is_present(&m->core, k);
    for (int k = 0; k < N_VARIANTS; k++) {
        int first = 0, count = apart(variants[k], m->present, &first);
        if (count < fewest)
            fewest = count, m->variant = k, part = first;
    }
    if (fewest == 0)
        return fmi2OK;
    const Literal *l = switch_of(&m->core, part);
    int with = variants[m->variant][part] == PRESENT, vr = variable_of(l);
    char wanted[40];
    if (variables[vr].kind == 'B')
        strcpy(wanted, l->nonzero == with ? "true" : "false");
    else
        snprintf(wanted, sizeof wanted, "%s%g", l->nonzero == with ? "other than " : "", l->variable >= CHANGED ? variables[vr].usual : 0.0);
    return fail(m, "%s: must be %s: this native FMU was compiled %s the part '%s'. Use the FMU that runs Python, or bake the scene.",
                shown(vr, m->core.values[vr], text), wanted, with ? "with" : "without", part_names[part]);
}

/* One row each where no table is baked in, zeros where there is none: as tables.current and sea.components. */
static void fill_tables(Instance *m)
{
    const double *x = m->core.values, omega = 2.0 * 3.141592653589793 / x[WAVE_PERIOD];
    const double level[3] = {0.0, x[CURRENT_SPEED] * cos(x[CURRENT_DIRECTION]), x[CURRENT_SPEED] * sin(x[CURRENT_DIRECTION])};
    const double along = cos(x[WAVE_DIRECTION]);
    const double wave[OF_A_WAVE] = {x[WAVE_AMPLITUDE], omega, omega * omega / x[GRAVITY], along, sin(x[WAVE_DIRECTION]), copysign(1.0, along),
                            x[WAVE_PHASE], 0.0, x[WAVE_AMPLITUDE] * omega, x[WAVE_AMPLITUDE]};
    memset(m->level, 0, sizeof m->level);
    if (m->present[CURRENT] != 0.0)
        memcpy(m->level, level, sizeof level);
    memcpy(m->wave, wave, sizeof wave);
}

static int64_t run(Instance *m, int what, double time, double step, double *outputs)
{
    int64_t status = OK;
    double inputs[N_INPUTS];
    for (int k = 0; k < N_INPUTS; k++)
        inputs[k] = m->core.values[inputs_at[k]];
    void *error = NULL;
    int levels = N_BAKED_LEVELS > 0 && m->present[CURRENT] != 0.0;
    int64_t n_waves = m->present[WAVES] == 0.0 ? 0 : N_BAKED_WAVES > 0 ? N_BAKED_WAVES : 1;
    int64_t order = what == SHAPE ? N_SHAPE / QUANTITIES : (int64_t)m->core.values[MOTION_ORDER];
    int broken = kernels[m->variant](&status, &error, what, time, step, order, inputs, m->numbers,
                                     m->present, levels ? baked_levels[0] : m->level, levels ? N_BAKED_LEVELS : 1,
                                     baked_current_table[0], N_BAKED_CURRENT_TABLE, N_BAKED_WAVES > 0 ? baked_waves[0] : m->wave, n_waves, baked_curve[0], N_BAKED_CURVE,
                                     baked_relief[0], N_BAKED_RELIEF, baked_sections[0], N_BAKED_SECTIONS, baked_line_bodies[0], N_BAKED_LINE_BODIES,
                                     m->state, m->n_state, m->work, m->n_work, outputs);
    for (int k = 0; what != SIZES && status == OK && k < N_OUTPUTS; k++)
        if (!isfinite(outputs[k]))
            status = NOT_FINITE;
    return broken ? NOT_FINITE : status;
}

static void keep_outputs(Instance *m, const double *outputs)
{
    for (int k = 0; k < N_OUTPUTS; k++)
        m->core.values[outputs_at[k]] = outputs[k];
    m->core.shaped = 0.0;
}

/* Each kind of doubt once. */
static void tell_doubts(Instance *m)
{
    for (unsigned k = 0; m->state[DOUBTS] > 0.0 && k < sizeof doubts / sizeof *doubts; k++) {
        const double *seen = m->state + DOUBT + 2 * k;
        if ((seen[0] != 0.0 || seen[1] != 0.0) && !(m->told & 1u << k)) {
            say(&m->log, fmi2Warning, doubts[k], seen[0], seen[1]);
            m->told |= 1u << k;
        }
    }
}

/* Checks the values, chooses the variant and makes room for its state. */
static fmi2Status prepare(Instance *m)
{
    double sizes[N_OUTPUTS] = {0.0};
    if (check_parameters(m) != fmi2OK || choose_variant(m) != fmi2OK)
        return fmi2Error;
    for (int k = 0; k < N_NUMBERS; k++) {
        Number from = numbers_from[k];
        m->numbers[k] = m->core.values[from.variable];
        if (from.below_zero >= 0 && m->numbers[k] < 0.0)
            m->numbers[k] = m->core.values[from.below_zero];
    }
    fill_tables(m);
    run(m, SIZES, 0.0, 0.0, sizes);
    give_back(m, m->state);
    m->n_state = (int64_t)sizes[0];
    m->n_work = (int64_t)sizes[1];
    m->state = take(m, (size_t)(m->n_state + m->n_work) * sizeof(double));
    if (!m->state)
        return fail(m, "memory = %.0f numbers: must be available. Reduce solver.nodes.", sizes[0] + sizes[1]);
    m->work = m->state + m->n_state;
    return fmi2OK;
}

static fmi2Status report(const Instance *m, int64_t status, double now, double speed)
{
    double time = fmax(m->state[ERROR_TIME], now), node = m->state[ERROR_NODE], size = m->state[ERROR_SIZE];
    (void)node;
    if (status == TOO_FAST)
        return fail(m, "speed of the top or lower end = %.10g m/s: must be %s", speed, TOO_FAST_TEXT);
    return fail(m, status > OK && status <= LAST_STATUS ? failures[status] : "%.6g s: unknown failure", FAILURE_ARGUMENTS);
}

static fmi2Status check_start(const Instance *m)
{
    for (size_t k = 0; k < sizeof start_rules / sizeof *start_rules; k++) {
        const StartRule *r = &start_rules[k];
        double value = m->core.values[r->variable], other = m->core.values[r->other];
        double slack = r->slack < 0 ? 0.0 : r->times * m->core.values[r->slack];
        char text[200];
        if (holds(&m->core, &r->when) && (r->equal ? value != other : value < other - slack))
            return fail(m, "%s: must be %s%.10g%s", shown(r->variable, value, text), r->before, other, r->after);
    }
    return fmi2OK;
}

static fmi2Status initialize(Instance *m)
{
    double outputs[N_OUTPUTS] = {0.0}; /* 0 where the kernels have nothing to tell */
    m->core.initialized = 0.0;
    if (prepare(m) != fmi2OK || check_start(m) != fmi2OK)
        return fmi2Error;
    int64_t status = run(m, START, m->core.start_time, 0.0, outputs);
    if (status != OK)
        return report(m, status, m->core.start_time, 0.0);
    keep_outputs(m, outputs);
    m->core.last_time = m->core.start_time;
    m->core.initialized = 1.0;
    m->core.outdated = 0.0;
    return fmi2OK;
}

/* The active effects and the values that switched them on, as effects.one_line. */
static const char *active_effects(Instance *m)
{
    size_t at = 0;
    int told = 0;
    m->active[0] = 0;
    for (size_t k = 0; m->core.initialized != 0.0 && k < sizeof effects / sizeof *effects && at < sizeof m->active; k++) {
        const Effect *e = &effects[k];
        double value = e->variable < 0 ? 0.0 : m->core.values[e->variable];
        char number[40] = "";
        if (!e->again)
            told = 0;
        if (told || !holds(&m->core, &e->when))
            continue;
        told = 1;
        if (e->variable >= 0)
            snprintf(number, sizeof number, "%g", value);
        if (e->variable >= 0 && variables[e->variable].kind == 'B')
            strcpy(number, value != 0.0 ? "true" : "false");
        at += (size_t)snprintf(m->active + at, sizeof m->active - at, "%s%s%s%s%s%s", at ? "; " : "", e->words, number,
                               *e->unit ? " " : "", e->unit, e->variable < 0 ? "" : ")");
    }
    return m->active;
}
