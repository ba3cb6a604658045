function job = servoscope_diagnose(measurement, varargin)
%SERVOSCOPE_DIAGNOSE  Asks where the model of an axis is wrong, and why.
%   J = servoscope_diagnose(M) queues a diagnosis of the measurement M, a
%   struct of servoscope_upload or an id. servoscope_wait gives its result.
%
%   J = servoscope_diagnose(M, 'Name', VALUE, ...) with the names
%     actuator_order   0, 1 or 2; left out: chosen from the data
%     method           how parameters are estimated
%     options          struct, such as struct('seed', 2)
%     validation       a second measurement, on which the improvement is measured
%
%   Example:
%     R = servoscope_wait(servoscope_diagnose(M, 'actuator_order', 0));
%     R.verdict, R.causes(1).effect, R.causes(1).confidence
    job = servoscope_submit('diagnose', measurement, varargin);
end
