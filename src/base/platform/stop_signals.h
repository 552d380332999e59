// What asks a program to stop, and what would end it without asking.
#pragma once

namespace hpm {

// Calls the handler with the number of the signal: SIGINT, SIGTERM, and SIGHUP
// unless it is ignored (nohup). System calls go on afterwards. Windows: Ctrl+C
// is SIGINT, Ctrl+Break, closing the console and logging off are SIGTERM; the
// handler runs in a thread of its own.
void CatchStopSignals(void (*handler)(int));

// A full disk or a closed pipe is an error of the write then, and not the end
// of the program.
void LetWritesFail();

}  // namespace hpm
