function job = servoscope_identify(measurement, varargin)
%SERVOSCOPE_IDENTIFY  Fits the base model to a measurement.
%   J = servoscope_identify(M) queues an identification of the measurement M,
%   a struct of servoscope_upload or an id. servoscope_wait gives its result.
%
%   J = servoscope_identify(M, 'Name', VALUE, ...) with the names
%   actuator_order, method and options, as for servoscope_diagnose.
%
%   Example:
%     R = servoscope_wait(servoscope_identify(M, 'actuator_order', 0));
%     R.parameters.pole.value, R.transfer_function.poles
    job = servoscope_submit('identify', measurement, varargin);
end
