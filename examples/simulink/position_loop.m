% SPDX-License-Identifier: Apache-2.0
% a position loop on the lift cylinder through libslewring_client, by loadlibrary and calllib
prefix = fullfile(getenv('HOME'), 'slewring');
loadlibrary(fullfile(prefix, 'lib', 'libslewring_client.so'), ...
            fullfile(prefix, 'include', 'slewring_client.h'), 'alias', 'slewring');
session = calllib('slewring', 'slewring_join', 'truck_crane', 'matlab', 0, 'lo', '', 10);
if isNull(session), error(calllib('slewring', 'slewring_error', [])); end
stroke = calllib('slewring', 'slewring_find', session, 'Cyl_Lift.stroke', 5);
lift   = calllib('slewring', 'slewring_acquire', session, 'Input_Lift', 5);
if stroke < 0 || lift < 0, error(calllib('slewring', 'slewring_error', session)); end
leave = onCleanup(@() calllib('slewring', 'slewring_leave', session));  % also after Ctrl-C
code = 0;
while code == 0 || code == -1  % -1: a pause
    code = calllib('slewring', 'slewring_step', session, 1);
    if code ~= 0, continue; end
    value = calllib('slewring', 'slewring_value', session, stroke);
    calllib('slewring', 'slewring_write', session, lift, max(-1, min(1, 20 * (0.86 - value))));
end
clear leave
unloadlibrary('slewring');
