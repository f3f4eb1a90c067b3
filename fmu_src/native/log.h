/* What a host is told: the logger it gave, and the categories of messages it asked for.  No instance, no model. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "fmi2Functions.h"

enum { ON_WARNING, ON_DISCARD, ON_ERROR, ON_FATAL, ALL_MESSAGES, N_CATEGORIES }; /* as LOG_CATEGORIES of model.h */
static const char *const log_categories[N_CATEGORIES] = {LOG_CATEGORIES};

typedef struct {
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    const char *name; /* of the instance */
    char chosen[N_CATEGORIES];
} Log;

/* Errors are told always, warnings until a host chooses other categories, and the rest where it asks for it. */
static void choose_categories(Log *log, int everything, int warnings)
{
    memset(log->chosen, everything, sizeof log->chosen);
    log->chosen[ON_ERROR] = log->chosen[ON_FATAL] = 1;
    log->chosen[ON_WARNING] |= (char)warnings;
}

static int category_of(fmi2Status status)
{
    return status == fmi2OK || status == fmi2Pending ? ALL_MESSAGES : (int)status - (int)fmi2Warning;
}

static void pass_on(const Log *log, fmi2Status status, const char *text) /* `text` is a printf format: hosts use it as one */
{
    int category = category_of(status);
    if (log->logger && (log->chosen[category] || log->chosen[ALL_MESSAGES]))
        log->logger(log->environment, log->name, status, log_categories[category], text);
}

static void tell(const Log *log, fmi2Status status, const char *format, va_list arguments)
{
    char text[2048], safe[4096];
    size_t n = 0;
    vsnprintf(text, sizeof text, format, arguments);
    for (const char *at = text; *at; at++) {
        if (*at == '%')
            safe[n++] = '%';
        safe[n++] = *at;
    }
    safe[n] = 0;
    pass_on(log, status, safe);
}

static fmi2Status say(const Log *log, fmi2Status status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    tell(log, status, format, arguments);
    va_end(arguments);
    return status;
}

static fmi2Status set_debug_logging(Log *log, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    char asked[N_CATEGORIES] = {0};
    if (n > 0 && !categories)
        return say(log, fmi2Error, "log categories: must be given. Pass as many names as there are.");
    for (size_t k = 0; k < n; k++) {
        int known = 0;
        for (int at = 0; at < N_CATEGORIES; at++)
            if (categories[k] && strcmp(categories[k], log_categories[at]) == 0)
                asked[at] = 1, known = 1;
        if (!known)
            return say(log, fmi2Error, "log category = '%.100s': must be one of modelDescription.xml. Choose one of its LogCategories.",
                       categories[k] ? categories[k] : "");
    }
    choose_categories(log, on && n == 0, 0);
    for (int at = 0; on && at < N_CATEGORIES; at++)
        log->chosen[at] |= asked[at];
    return fmi2OK;
}
