!> Frame whose restoring force follows Bouc and Wen, a smooth hysteresis with one more state z.
!>
!>    F/m_s = omega_s**2 (a u + (1 - a) u_y z)
!>    z' = u'/u_y (1 - |z|**n (beta sign(u' z) + 1 - beta))
!>
!> a is the hardening ratio. beta + gamma = 1, so that |z| tends to 1; any other sum would only
!> rescale u_y. For n -> infinity the law becomes the bilinear one of `spring_t`.
!>
!> The signs of u' and z are constant within a piece of motion. The hybrid loop ends a piece at a
!> peak and where z passes zero. Within a step the rate of z is smooth. An exception is the start
!> from z = 0 if n is not a natural number.
module rwmf_model_hysteresis_bouc_wen
   use rwmf_core_kinds, only: wp
   use rwmf_model_equation, only: contribution_t, discrete_state_t, equation_t, &
      frame_displacement, frame_mass, frame_travel, hysteresis_t, model_t, &
      motion_signs_t, renew_effects
   use rwmf_model_hysteresis_bouc_wen_backbone, only: unloaded_displacement, &
      virgin_displacement
   use rwmf_problem_case, only: case_t, spring_law_t
   use rwmf_problem_frame_strength, only: frame_hardening, frame_law, yield_displacement
   implicit none
   private

   public :: prepare_bouc_wen, new_hysteresis, follow_loading_direction, follow_signs
   public :: will_pass_zero, stable_rate, load_bouc_wen, bouc_wen_sizes
   public :: bouc_wen_energy, bouc_wen_residual, bouc_wen_force, lagging_displacement

contains

   !> Set the parameters and the position of z among the states.
   subroutine prepare_bouc_wen(case, equation)
      type(case_t), intent(in) :: case
      !! case whose frame has strength
      type(equation_t), intent(inout) :: equation

      equation%hysteresis = new_hysteresis(frame_law(case), frame_hardening(case), &
         yield_displacement(case), equation%p%omega_squared)
      equation%hysteresis%place = equation%scene%n + 1
      equation%state%frame_slope = equation%hysteresis%hardening*equation%p%omega_squared
      equation%has_loading_direction = .true.
      equation%state%ends_at_peak = .true.
   end subroutine prepare_bouc_wen

   !> Load a frame at rest to an initial displacement, as if it had grown slowly from zero.
   subroutine load_bouc_wen(equation, y)
      type(equation_t), intent(in) :: equation
      !! equation with the current side
      real(wp), intent(inout) :: y(:)
      !! (states)

      associate (law => equation%hysteresis)
         y(law%place) = virgin_displacement(frame_displacement(equation, equation%state%side, &
            y)/law%u_y, law%exponent)
      end associate
   end subroutine load_bouc_wen

   !> Create the law of one spring.
   pure type(hysteresis_t) function new_hysteresis(given, hardening, u_y, stiffness) result(law)
      type(spring_law_t), intent(in) :: given
      !! 'bouc_wen' with exponent and beta
      real(wp), intent(in) :: hardening
      !! stiffness after yielding over elastic stiffness [-]
      real(wp), intent(in) :: u_y
      !! displacement at yield [m]
      real(wp), intent(in) :: stiffness
      !! elastic stiffness over any mass [1/s2]
      real(wp), parameter :: most = 8
      !! largest number of factors whose product is as accurate as a power, and faster [-]

      law%u_y = u_y
      law%hardening = hardening
      law%exponent = given%exponent
      law%beta = given%beta
      law%force_at_z1 = (stiffness - law%hardening*stiffness)*law%u_y
      if (law%exponent > most .or. abs(law%exponent - anint(law%exponent)) > 0) return
      law%factors = nint(law%exponent)
   end function new_hysteresis

   !> Update the lost part and the coefficients at the beginning of a piece of motion, from the
   !> signs of u' and z.
   pure subroutine follow_loading_direction(model, state, y)
      type(model_t), intent(in) :: model
      type(discrete_state_t), intent(inout) :: state
      real(wp), intent(in) :: y(:)
      !! (states)
      real(wp) :: lost

      lost = state%signs%lost
      call follow_signs(model%hysteresis, y(model%hysteresis%place), state%signs)
      if (abs(state%signs%lost - lost) > 0) call renew_effects(model, state)
   end subroutine follow_loading_direction

   !> Set the sense and the lost part of one law from the signs of u' and z.
   pure subroutine follow_signs(law, z, signs)
      type(hysteresis_t), intent(in) :: law
      real(wp), intent(in) :: z
      !! hysteretic state [-]
      type(motion_signs_t), intent(inout) :: signs
      !! signs, with the loading direction already set

      signs%sense = signs%loading_direction
      signs%lost = 1
      if (signs%loading_direction*z < 0) then
         signs%sense = -signs%loading_direction
         signs%lost = 1 - 2*law%beta
      end if
      if (modulo(law%factors, 2) == 1) signs%lost = signs%sense*signs%lost
   end subroutine follow_signs

   !> Return whether |z| decreases in the current piece of motion, so that z may pass zero.
   pure logical function will_pass_zero(equation)
      type(equation_t), intent(in) :: equation

      will_pass_zero = equation%state%signs%sense /= equation%state%signs%loading_direction
   end function will_pass_zero

   !> Steps per radian that keep an explicit Runge-Kutta pair stable while z relaxes to its bound
   !> [1/rad]. With fewer steps the true error far exceeds the embedded error estimate.
   pure real(wp) function stable_rate(equation) result(pace)
      type(equation_t), intent(in) :: equation
      real(wp), parameter :: longest = 4.5_wp
      !! largest stable step over the time constant of z at its bound [-]

      associate (law => equation%hysteresis)
         pace = law%exponent*abs(equation%state%signs%lost)*frame_travel(equation) &
            /(longest*law%u_y)
      end associate
   end function stable_rate

   !> Estimate the size of z: u/u_y while the frame is elastic, at most 1.
   subroutine bouc_wen_sizes(effect, equation, size_guess, sizes)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      !! sizes of theta and theta' [rad], [rad/s] or of u and u' [m], [m/s]
      real(wp), intent(out) :: sizes(:)
      !! (states of the effect) size of z [-]

      sizes = min(1.0_wp, frame_travel(equation)*size_guess(1)/equation%hysteresis%u_y)
   end subroutine bouc_wen_sizes

   !> Strain energy of the frame minus that of an elastic one; its kinetic part is zero [J/kg].
   function bouc_wen_energy(effect, equation, y) result(energy)
      type(contribution_t), intent(in) :: effect
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! states
      real(wp) :: energy(2)

      energy(1) = 0
      associate (law => equation%hysteresis)
         energy(2) = frame_mass(equation)*equation%p%omega_s**2*(1 - law%hardening)/2 &
            *((law%u_y*y(law%place))**2 - frame_displacement(equation, equation%state%side, &
            y)**2)
      end associate
   end function bouc_wen_energy

   !> Displacement of zero frame force after slow unloading [m].
   real(wp) function bouc_wen_residual(equation, y) result(residual)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      associate (law => equation%hysteresis)
         residual = law%u_y*unloaded_displacement(frame_displacement(equation, &
            equation%state%side, y)/law%u_y, y(law%place), law%hardening, law%beta, law%exponent)
      end associate
   end function bouc_wen_residual

   !> Restoring force of the frame over m_s [m/s2].
   real(wp) function bouc_wen_force(equation, y) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      force = equation%p%omega_s**2*(frame_displacement(equation, equation%state%side, y) &
         - lagging_displacement(equation, y))
   end function bouc_wen_force

   !> Displacement minus the force over the elastic stiffness [m].
   real(wp) function lagging_displacement(equation, y) result(lag)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      associate (law => equation%hysteresis)
         lag = (1 - law%hardening)*(frame_displacement(equation, equation%state%side, y) &
            - law%u_y*y(law%place))
      end associate
   end function lagging_displacement

end module rwmf_model_hysteresis_bouc_wen
