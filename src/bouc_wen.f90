!> Frame whose restoring force follows Bouc and Wen: a smooth hysteresis with one more state z.
!>
!>    F/m_s = omega_s**2 (a u + (1 - a) u_y z)
!>    z' = u'/u_y (1 - |z|**n (beta sign(u' z) + 1 - beta))
!>
!> a is the hardening ratio. beta + gamma = 1, so that |z| tends to 1: another sum would only give
!> u_y another meaning. For n -> infinity the law becomes the bilinear one of `spring.f90`.
!>
!> The sign of u' is that of the course in force, which the hybrid loop turns over at a peak: inside
!> a step the rate of z is smooth.
module rwmf_bouc_wen
   use rwmf_case, only: case_t
   use rwmf_first_loading, only: first_loading
   use rwmf_kinds, only: wp
   use rwmf_kinematics, only: kinematics_t
   use rwmf_memory, only: yield_displacement
   use rwmf_scene, only: equation_t, frame_displacement, frame_mass, frame_travel, frame_velocity
   implicit none
   private

   public :: prepare_bouc_wen, load_bouc_wen, add_bouc_wen, bouc_wen_rates, bouc_wen_sizes
   public :: bouc_wen_power, bouc_wen_energy, bouc_wen_residual, bouc_wen_force

contains

   !> Parameters, and the place of z among the states.
   subroutine prepare_bouc_wen(case, equation)
      type(case_t), intent(in) :: case
      !! with `&yielding`
      type(equation_t), intent(inout) :: equation

      equation%hysteresis%u_y = yield_displacement(case)
      equation%hysteresis%hardening = case%yielding%hardening
      equation%hysteresis%exponent = case%yielding%exponent
      equation%hysteresis%beta = case%yielding%beta
      equation%hysteresis%place = equation%n + 1
      equation%has_course = .true.
      equation%ends_at_peak = .true.
   end subroutine prepare_bouc_wen

   !> Bring a frame that has not moved yet to an initial displacement, as if it had grown from zero.
   subroutine load_bouc_wen(equation, y)
      type(equation_t), intent(in) :: equation
      !! with the side in force
      real(wp), intent(inout) :: y(:)
      !! (states)

      associate (law => equation%hysteresis)
         y(law%place) = first_loading(frame_displacement(equation, y(1))/law%u_y, law%exponent)
      end associate
   end subroutine load_bouc_wen

   !> What the frame's force differs by from the elastic one, which is in the equation already.
   subroutine add_bouc_wen(equation, t, y, kin, inertia, moment)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      type(kinematics_t), intent(in) :: kin
      real(wp), intent(inout) :: inertia
      real(wp), intent(inout) :: moment

      associate (law => equation%hysteresis, p => equation%p)
         moment = moment + frame_mass(equation)*kin%lever*p%omega_s**2*(1 - law%hardening) &
            *(kin%u - equation%side*law%u_y*y(law%place)/p%R)
      end associate
   end subroutine add_bouc_wen

   !> Rate of z.
   subroutine bouc_wen_rates(equation, t, y, rates)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: rates(:)

      rates = frame_velocity(equation, y)/equation%hysteresis%u_y*(1 - lost_part(equation, y))
   end subroutine bouc_wen_rates

   !> Part of the velocity that goes into plastic flow [-].
   real(wp) function lost_part(equation, y)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      real(wp), parameter :: farthest = 1.26_wp
      !! |z| of a trial state that no step keeps; its power of 1000 is a number [-]
      real(wp), parameter :: largest = 1.0e3_wp
      !! of such powers: the next trial state stays a number as well

      associate (law => equation%hysteresis)
         associate (z => y(law%place))
            lost_part = min(min(abs(z), farthest)**law%exponent, largest)*(1 - law%beta &
               + sign(law%beta, equation%course*z))
         end associate
      end associate
   end function lost_part

   !> z is below 1, and u/u_y while the frame is elastic.
   subroutine bouc_wen_sizes(equation, size_guess, sizes)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: size_guess(2)
      real(wp), intent(out) :: sizes(:)

      sizes = min(1.0_wp, frame_travel(equation)*size_guess(1)/equation%hysteresis%u_y)
   end subroutine bouc_wen_sizes

   !> Power that plastic flow takes [W/kg].
   real(wp) function bouc_wen_power(equation, t, y) result(power)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: t
      real(wp), intent(in) :: y(:)

      associate (law => equation%hysteresis)
         power = frame_mass(equation)*equation%p%omega_s**2*(1 - law%hardening)*law%u_y &
            *y(law%place)*frame_velocity(equation, y)*lost_part(equation, y)
      end associate
   end function bouc_wen_power

   !> Energy stored beyond that of the elastic frame, which the ledger has [J/kg].
   real(wp) function bouc_wen_energy(equation, y) result(energy)
      class(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)

      associate (law => equation%hysteresis)
         energy = frame_mass(equation)*equation%p%omega_s**2*(1 - law%hardening)/2 &
            *((law%u_y*y(law%place))**2 - frame_displacement(equation, y(1))**2)
      end associate
   end function bouc_wen_energy

   !> Displacement that elastic unloading would leave: F = m_s omega_s**2 (u - residual) [m].
   real(wp) function bouc_wen_residual(equation, y) result(residual)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      associate (law => equation%hysteresis)
         residual = (1 - law%hardening)*(frame_displacement(equation, y(1)) &
            - law%u_y*y(law%place))
      end associate
   end function bouc_wen_residual

   !> Restoring force of the frame over m_s [m/s2].
   real(wp) function bouc_wen_force(equation, y) result(force)
      type(equation_t), intent(in) :: equation
      real(wp), intent(in) :: y(:)
      !! (states)

      force = equation%p%omega_s**2*(frame_displacement(equation, y(1)) &
         - bouc_wen_residual(equation, y))
   end function bouc_wen_force

end module rwmf_bouc_wen
