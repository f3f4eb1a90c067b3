/* The calls of FMI 3.0 that the capability flags and the variables' types leave out.  Included once, after absent.h. */

#define LEFT_OUT(call, ...) \
    fmi3Status call(fmi3Instance c, ##__VA_ARGS__) { return (fmi3Status)absent(c, #call); }

/* -- modes */

LEFT_OUT(fmi3EnterEventMode)
LEFT_OUT(fmi3EnterStepMode)
LEFT_OUT(fmi3EnterConfigurationMode)
LEFT_OUT(fmi3ExitConfigurationMode)
LEFT_OUT(fmi3EnterContinuousTimeMode)
LEFT_OUT(fmi3EvaluateDiscreteStates)
LEFT_OUT(fmi3UpdateDiscreteStates, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals, fmi3Boolean *states,
         fmi3Boolean *defined, fmi3Float64 *next)

/* -- variables of types that no variable has */

#define REFERENCES const fmi3ValueReference vr[], size_t n
#define NO_VARIABLES(Kind)                                                       \
    LEFT_OUT(fmi3Get##Kind, REFERENCES, fmi3##Kind value[], size_t n_values)     \
    LEFT_OUT(fmi3Set##Kind, REFERENCES, const fmi3##Kind value[], size_t n_values)
NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
LEFT_OUT(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary value[], size_t n_values)
LEFT_OUT(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary value[], size_t n_values)

/* -- clocks */

LEFT_OUT(fmi3GetClock, REFERENCES, fmi3Clock value[])
LEFT_OUT(fmi3SetClock, REFERENCES, const fmi3Clock value[])
LEFT_OUT(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
LEFT_OUT(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
LEFT_OUT(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
LEFT_OUT(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
LEFT_OUT(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
LEFT_OUT(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
LEFT_OUT(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
LEFT_OUT(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
LEFT_OUT(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

/* -- dependencies and derivatives */

LEFT_OUT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference vr, size_t *n)
LEFT_OUT(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t of[], fmi3ValueReference independents[], size_t on[],
         fmi3DependencyKind kinds[], size_t n)
LEFT_OUT(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 value[], size_t n_values)
#define PARTIAL                                                                                                                         \
    const fmi3ValueReference unknowns[], size_t n_unknowns, const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[], \
        size_t n_seed, fmi3Float64 made[], size_t n_made
LEFT_OUT(fmi3GetDirectionalDerivative, PARTIAL)
LEFT_OUT(fmi3GetAdjointDerivative, PARTIAL)

/* -- model exchange */

LEFT_OUT(fmi3CompletedIntegratorStep, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *terminate)
LEFT_OUT(fmi3SetTime, fmi3Float64 time)
LEFT_OUT(fmi3SetContinuousStates, const fmi3Float64 states[], size_t n)
LEFT_OUT(fmi3GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t n)
LEFT_OUT(fmi3GetEventIndicators, fmi3Float64 indicators[], size_t n)
LEFT_OUT(fmi3GetContinuousStates, fmi3Float64 states[], size_t n)
LEFT_OUT(fmi3GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t n)
LEFT_OUT(fmi3GetNumberOfEventIndicators, size_t *n)
LEFT_OUT(fmi3GetNumberOfContinuousStates, size_t *n)
