/* The calls of FMI 2.0 that the capability flags leave out, and those that ask for a step that is pending.  Included once, where log_of is. */

static fmi2Status absent(fmi2Component c, const char *call)
{
    return c ? say(log_of(c), fmi2Error, "%s: must not be called: the capability flags of modelDescription.xml leave it out.", call) : fmi2Error;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference from[], size_t n_known, const fmi2Real seed[], fmi2Real made[])
{
    (void)unknown, (void)n_unknown, (void)from, (void)n_known, (void)seed, (void)made;
    return absent(c, "fmi2GetDirectionalDerivative");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                        fmi2Real value[])
{
    (void)vr, (void)n, (void)order, (void)value;
    return absent(c, "fmi2GetRealOutputDerivatives");
}

#define NO_STATUS(Kind, type)                                                                  \
    fmi2Status fmi2Get##Kind(fmi2Component c, const fmi2StatusKind kind, type *value)          \
    {                                                                                          \
        (void)c, (void)kind, (void)value;                                                      \
        return fmi2Discard; /* steps are never pending */                                      \
    }
NO_STATUS(Status, fmi2Status)
NO_STATUS(IntegerStatus, fmi2Integer)
NO_STATUS(StringStatus, fmi2String)
