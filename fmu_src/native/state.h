/* Complete states: saved, restored, as bytes, and checked whole when they come back.  Included once, by fmu.c. */

typedef struct {
    uint64_t size; /* numbers in `state` */
    Core core;
    double state[];
} Saved;

typedef struct {
    char magic[8], guid[40];
    uint64_t checksum;
} Head;

static const char magic[8] = "CABLEFM3";
static const char *const only_own = "Restore only what the same FMU has saved.";

static size_t bytes(const Saved *saved) { return sizeof *saved + saved->size * sizeof(double); }

static uint64_t checksum(const void *data, size_t size) /* FNV-1a */
{
    uint64_t sum = 14695981039346656037u;
    for (const unsigned char *at = data, *end = at + size; at < end; at++)
        sum = (sum ^ *at) * 1099511628211u;
    return sum;
}

static int is_flag(double value) { return value == 0.0 || value == 1.0; }

static int is_whole(double value, double least, double most) { return value >= least && value <= most && value == floor(value); }

static int can_be(char kind, double value)
{
    return kind == 'R' ? isfinite(value) : kind == 'B' ? is_flag(value) : kind == 'I' ? is_whole(value, -2147483648.0, 2147483647.0) : 1;
}

/* The first part of a state that no instance can be in; NULL: there is none. */
static const char *impossible(const Saved *saved)
{
    const Core *core = &saved->core;
    if (!is_whole(core->phase, INSTANTIATED, FAILED_AND_TERMINATED) || !is_flag(core->initialized) || !is_flag(core->outdated))
        return "phase";
    if (!is_flag(core->set_up) || !is_flag(core->has_stop) || !is_flag(core->shaped))
        return "phase";
    if (core->initialized == 0.0 && (core->phase > INITIALIZING || (core->phase == INITIALIZING && core->outdated == 0.0)))
        return "phase";
    if (!isfinite(core->start_time) || !isfinite(core->stop_time) || !isfinite(core->last_time))
        return "time";
    for (int vr = 0; vr < N_VARIABLES; vr++)
        if (!can_be(variables[vr].kind, core->values[vr]))
            return variables[vr].name;
    if ((core->initialized != 0.0) != (saved->size > 0))
        return "size";
    for (uint64_t k = 0; k < saved->size; k++)
        if (!isfinite(saved->state[k]))
            return "cable";
    return NULL;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (!c)
        return fmi2Error;
    if (state) {
        give_back(c, *state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    const Instance *m = c;
    if (!m)
        return fmi2Error;
    if (!state)
        return fail(m, "place of the saved state: must be given. Pass the address of an " FMI FMU_STATE ".");
    uint64_t size = m->core.initialized != 0.0 ? (uint64_t)m->n_state : 0;
    Saved *saved = take(m, sizeof *saved + size * sizeof(double));
    if (!saved)
        return fail(m, "memory: must be available for the saved state. Free some states.");
    saved->size = size;
    saved->core = m->core;
    if (size > 0)
        memcpy(saved->state, m->state, size * sizeof(double));
    fmi2FreeFMUstate(c, state);
    *state = saved;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    Instance *m = c;
    const Saved *saved = state;
    if (!m)
        return fmi2Error;
    if (!saved)
        return fail(m, "saved state: must not be empty. Save one first.");
    if (saved->size == 0) {
        m->core = saved->core;
        return fmi2OK;
    }
    Instance next = *m; /* m stays as it is where the state is refused */
    next.core = saved->core;
    next.state = NULL;
    if (prepare(&next) != fmi2OK || (uint64_t)next.n_state != saved->size) {
        give_back(m, next.state);
        return fail(m, "saved state = %.0f numbers: must be those of its own parameters. %s", (double)saved->size, only_own);
    }
    memcpy(next.state, saved->state, saved->size * sizeof(double));
    give_back(m, m->state);
    *m = next;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    if (!c)
        return fmi2Error;
    if (!state || !size)
        return fail(c, "saved state: must not be empty. Save one first.");
    *size = sizeof(Head) + bytes(state);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte to[], size_t size)
{
    size_t wanted = 0;
    if (fmi2SerializedFMUstateSize(c, state, &wanted) != fmi2OK)
        return fmi2Error;
    if (size < wanted || !to)
        return fail(c, "room for the saved state = %zu bytes: must be at least %zu. Ask " FMI "Serialized" FMU_STATE "Size.", to ? size : 0, wanted);
    Head head = {.checksum = checksum(state, bytes(state))};
    memcpy(head.magic, magic, sizeof magic);
    strncpy(head.guid, MODEL_GUID, sizeof head.guid - 1);
    memcpy(to, &head, sizeof head);
    memcpy(to + sizeof head, state, bytes(state));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte from[], size_t size, fmi2FMUstate *state)
{
    Head head;
    Saved begin;
    if (!c)
        return fmi2Error;
    if (!from || !state)
        return fail(c, "saved state: must be given, and a place for it. Pass what " FMI "Serialize" FMU_STATE " wrote.");
    if (size < sizeof head + sizeof begin)
        return fail(c, "saved state = %zu bytes: must be at least %zu. %s", size, sizeof head + sizeof begin, only_own);
    memcpy(&head, from, sizeof head);
    memcpy(&begin, from + sizeof head, sizeof begin);
    if (memcmp(head.magic, magic, sizeof magic) != 0 || strncmp(head.guid, MODEL_GUID, sizeof head.guid) != 0)
        return fail(c, "saved state: must be of this build of the FMU. %s", only_own);
    if (begin.size > size / sizeof(double) || size != sizeof head + bytes(&begin))
        return fail(c, "saved state = %zu bytes: must be complete. %s", size, only_own);
    if (head.checksum != checksum(from + sizeof head, size - sizeof head))
        return fail(c, "saved state: must have its checksum. It was changed; restore only what the same FMU has saved.");
    Saved *saved = take(c, bytes(&begin));
    if (!saved)
        return fail(c, "memory: must be available for the saved state. Free some states.");
    memcpy(saved, from + sizeof head, bytes(&begin));
    const char *wrong = impossible(saved);
    if (wrong) {
        give_back(c, saved);
        return fail(c, "saved state of '%s': must be one that this FMU can be in. %s", wrong, only_own);
    }
    fmi2FreeFMUstate(c, state);
    *state = saved;
    return fmi2OK;
}
