/* Getting and setting variables by their value references.  Included once, by fmu.c. */

static const char *kind_name(char kind) { return kind == 'R' ? REAL : kind == 'I' ? INTEGER : kind == 'B' ? "Boolean" : "String"; }

static fmi2Status known(const Instance *m, fmi2ValueReference vr, char kind)
{
    if (vr >= N_VARIABLES)
        return fail(m, "value reference = %u: must be below %d. Use the references of modelDescription.xml.", vr, N_VARIABLES);
    if (variables[vr].kind != kind)
        return fail(m, "%s as %s: must be got and set as %s. Use the types of modelDescription.xml.", variables[vr].name, kind_name(kind),
                    kind_name(variables[vr].kind));
    return fmi2OK;
}

/* What a host hands over: an instance, and arrays where they have elements. */
static fmi2Status handed(const Instance *m, const fmi2ValueReference vr[], size_t n, const void *values)
{
    if (!m)
        return fmi2Error;
    if (n > 0 && (!vr || !values))
        return fail(m, "value references and values: must be given. Pass as many as there are.");
    return fmi2OK;
}

/* While initialization lasts, outputs are those of the equilibrium under the values that are set by then. */
static fmi2Status preview(Instance *m)
{
    return m->core.phase == INITIALIZING && m->core.outdated != 0.0 ? initialize(m) : fmi2OK;
}

/* The shape is worked out where it is asked for: most hosts do not. */
static fmi2Status tell_shape(Instance *m, const fmi2ValueReference vr[], size_t n)
{
    size_t asked = 0;
    while (asked < n && (vr[asked] < SHAPE_AT || vr[asked] >= SHAPE_AT + N_SHAPE))
        asked++;
    if (asked == n || m->core.shaped != 0.0)
        return fmi2OK;
    if (m->core.phase == FAILED || m->core.phase == FAILED_AND_TERMINATED)
        return fail(m, "%s: must be asked for before a step fails. Restore a state, or reset the FMU.", variables[vr[asked]].name);
    double told[N_OUTPUTS + N_SHAPE] = {0.0};
    int64_t status = run(m, SHAPE, m->core.last_time, 0.0, told);
    if (status != OK)
        return report(m, status, m->core.last_time, 0.0);
    memcpy(m->core.values + SHAPE_AT, told + N_OUTPUTS, sizeof told - N_OUTPUTS * sizeof *told);
    m->core.shaped = 1.0;
    return fmi2OK;
}

static fmi2Status may_get(const Instance *m, fmi2ValueReference vr, char kind)
{
    if (known(m, vr, kind) != fmi2OK)
        return fmi2Error;
    if (m->core.phase == INSTANTIATED && (variables[vr].causality == 'o' || variables[vr].causality == 'l'))
        return fail(m, "%s: must be asked for after initialization has begun. Enter the initialization mode first.", variables[vr].name);
    return fmi2OK;
}

static fmi2Status may_set(const Instance *m, fmi2ValueReference vr, char kind, double value)
{
    if (known(m, vr, kind) != fmi2OK)
        return fmi2Error;
    const Variable *v = &variables[vr];
    if (v->causality == 'p' && m->core.phase > INITIALIZING)
        return refuse(m, (int)vr, value, "set before the end of initialization. Reset the FMU first.");
    if (v->causality != 'p' && v->causality != 'i')
        return refuse(m, (int)vr, value, "left alone: it is calculated. Set inputs and parameters only.");
    if (m->core.phase >= TERMINATED)
        return refuse(m, (int)vr, value, "set before the end of the simulation. Reset the FMU first.");
    if (!isfinite(value))
        return refuse(m, (int)vr, value, *v->kept ? v->kept : v->finite);
    return fmi2OK;
}

#define GETTER(Kind, letter)                                                                                     \
    fmi2Status fmi2Get##Kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2##Kind value[])       \
    {                                                                                                            \
        Instance *m = c;                                                                                         \
        if (handed(m, vr, n, value) != fmi2OK)                                                                   \
            return fmi2Error;                                                                                    \
        for (size_t k = 0; k < n; k++)                                                                           \
            if (may_get(m, vr[k], letter) != fmi2OK)                                                             \
                return fmi2Error;                                                                                \
        if (preview(m) != fmi2OK || tell_shape(m, vr, n) != fmi2OK)                                              \
            return fmi2Error;                                                                                    \
        for (size_t k = 0; k < n; k++)                                                                           \
            value[k] = (fmi2##Kind)m->core.values[vr[k]];                                                        \
        return fmi2OK;                                                                                           \
    }
/* all of them or none */
#define SETTER(Kind, letter, as_number)                                                                          \
    fmi2Status fmi2Set##Kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2##Kind value[]) \
    {                                                                                                            \
        Instance *m = c;                                                                                         \
        if (handed(m, vr, n, value) != fmi2OK)                                                                   \
            return fmi2Error;                                                                                    \
        for (size_t k = 0; k < n; k++)                                                                           \
            if (may_set(m, vr[k], letter, as_number) != fmi2OK)                                                  \
                return fmi2Error;                                                                                \
        for (size_t k = 0; k < n; k++)                                                                           \
            m->core.values[vr[k]] = as_number;                                                                   \
        m->core.outdated = 1.0;                                                                                  \
        return fmi2OK;                                                                                           \
    }
GETTER(Real, 'R')
GETTER(Integer, 'I')
GETTER(Boolean, 'B')
SETTER(Real, 'R', value[k])
SETTER(Integer, 'I', value[k])
SETTER(Boolean, 'B', value[k] != fmi2False)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[])
{
    Instance *m = c;
    if (handed(m, vr, n, value) != fmi2OK)
        return fmi2Error;
    for (size_t k = 0; k < n; k++)
        if (may_get(m, vr[k], 'S') != fmi2OK)
            return fmi2Error;
    if (preview(m) != fmi2OK)
        return fmi2Error;
    for (size_t k = 0; k < n; k++)
        value[k] = active_effects(m);
    return fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String value[])
{
    Instance *m = c;
    if (handed(m, vr, n, value) != fmi2OK)
        return fmi2Error;
    for (size_t k = 0; k < n; k++)
        if (known(m, vr[k], 'S') == fmi2OK)
            return fail(m, "%s = '%.100s': must be left alone: it is calculated. Set inputs and parameters only.", variables[vr[k]].name,
                        value[k] ? value[k] : "");
        else
            return fmi2Error;
    return fmi2OK;
}

/* The input that is the derivative of another one's, as a velocity of a position; none: N_VARIABLES.  Inputs are position, velocity and
   acceleration of the top, the winch's speed, and the same nine of the lower end; those after them have none. */
static int derivative_of(const Instance *m, fmi2ValueReference vr, fmi2Integer order)
{
    for (int k = 0; k < N_INPUTS; k++)
        if (inputs_at[k] == (int)vr && k < N_ENDS && k % 10 < 9)
            return k % 10 / 3 + order <= (int)m->core.values[MOTION_ORDER] ? inputs_at[k + 3 * order] : N_VARIABLES;
    return N_VARIABLES;
}

/* Derivatives of inputs are inputs themselves.  One that nothing follows is said once, as a warning: hosts give those of all inputs. */
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                       const fmi2Real value[])
{
    Instance *m = c;
    fmi2Status status = fmi2OK;
    if (handed(m, vr, n, value) != fmi2OK || handed(m, vr, n, order) != fmi2OK)
        return fmi2Error;
    for (size_t k = 0; k < n; k++) {
        if (may_set(m, vr[k], 'R', value[k]) != fmi2OK)
            return fmi2Error;
        if (variables[vr[k]].causality != 'i')
            return fail(m, "derivative of %s: must be that of an input. Set parameters themselves.", variables[vr[k]].name);
        if (order[k] < 1)
            return fail(m, "order of the derivative of %s = %d: must be 1 or more. Set values themselves by fmi2SetReal.",
                        variables[vr[k]].name, order[k]);
    }
    for (size_t k = 0; k < n; k++) {
        int to = order[k] <= 2 ? derivative_of(m, vr[k], order[k]) : N_VARIABLES;
        if (to < N_VARIABLES) {
            m->core.values[to] = value[k];
            continue;
        }
        status = fmi2Warning;
        if (!m->unused)
            say(&m->log, fmi2Warning, "derivative of order %d of %s = not followed: top.motion_order = %d says how much of the motion is. "
                "Set top.motion_order, or leave that derivative out.", order[k], variables[vr[k]].name, (int)m->core.values[MOTION_ORDER]);
        m->unused = 1;
    }
    m->core.outdated = 1.0;
    return status;
}
