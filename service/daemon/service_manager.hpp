// Reports to systemd how the service is (sd_notify(3): one datagram to $NOTIFY_SOCKET); does
// nothing where no service manager listens.
#pragma once

namespace reident {

void notify_service_manager(const char* state);  // such as "READY=1"

}  // namespace reident
