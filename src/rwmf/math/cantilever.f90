!> Modes of a uniform cantilever in bending and shear, without rotary inertia.
!>
!> With x the height over the length, psi the rotation of the section, and Lambda = omega**2 over
!> EI/(m L**4), the total deflection phi of a mode obeys
!>
!>    phi'''' + Lambda epsilon phi'' - Lambda phi = 0,   epsilon = EI/(kappa G A L**2),
!>    phi = psi = 0 at the base,   psi' = psi'' = 0 at the tip.
!>
!> Its solutions have the real exponent a and the wave number c, with a c = sqrt(Lambda) and
!> c**2 - a**2 = Lambda epsilon; epsilon = 0 is Euler and Bernoulli's beam, a = c. The frequency
!> equation is 2 + cosh(a) cos(c) (c**2/a**2 + a**2/c**2) = sinh(a) sin(c) (c/a - a/c). Growing
!> exponentials are written from the tip, so that no mode loses digits.
module rwmf_math_cantilever
   use rwmf_core_kinds, only: pi, wp
   use rwmf_math_gauss, only: gauss_node
   implicit none
   private

   public :: cantilever_mode_t, find_cantilever_mode
   public :: deflection, slope_of, force_above, moment_above

   !> Mode with unit deflection at the tip.
   type :: cantilever_mode_t
      real(wp) :: c = 0
      !! wave number [-]
      real(wp) :: a = 0
      !! exponent [-]
      real(wp) :: growing = 0
      !! factor of exp(a (x - 1)) [-]
      real(wp) :: decaying = 0
      !! factor of exp(-a x) [-]
      real(wp) :: cosine = 0
      !! factor of cos(c x) [-]
      real(wp) :: sine = 0
      !! factor of sin(c x) [-]
      real(wp) :: norm = 0
      !! integral of phi**2 over the height [-]
   end type cantilever_mode_t

contains

   !> Find a mode by its number. Its wave number lies between (number - 1) pi and number pi.
   pure type(cantilever_mode_t) function find_cantilever_mode(number, epsilon) result(mode)
      integer, intent(in) :: number
      !! number of the mode, 1 for the slowest
      real(wp), intent(in) :: epsilon
      !! flexibility in shear EI/(kappa G A L**2), 0 for none [-]
      real(wp) :: low, high
      real(wp) :: cosine_end, sine_end, tip

      low = (number - 1)*pi
      high = number*pi
      do
         mode%c = (low + high)/2
         if (mode%c <= low .or. mode%c >= high) exit
         if (sign(1.0_wp, frequency_function(mode%c, epsilon)) &
             > 0 .eqv. mod(number, 2) == 1) then
            low = mode%c
         else
            high = mode%c
         end if
      end do
      mode%a = mode%c/sqrt(1 + epsilon*mode%c**2)
      associate (a => mode%a, c => mode%c, decay => exp(-mode%a))
         ! bending moment and shear vanish at the tip
         cosine_end = (a/c)**2*cos(c)
         sine_end = c/a*sin(c)
         mode%cosine = -(1 - decay**2 + 2*decay*sine_end)
         mode%sine = (c/a)**3*(1 + decay**2 + 2*decay*cosine_end)
         mode%growing = sine_end - cosine_end - decay
         mode%decaying = 1 + decay*(sine_end + cosine_end)
      end associate
      tip = deflection(mode, 1.0_wp)
      mode%growing = mode%growing/tip
      mode%decaying = mode%decaying/tip
      mode%cosine = mode%cosine/tip
      mode%sine = mode%sine/tip
      mode%norm = norm_of(mode, number)
   end function find_cantilever_mode

   !> Left side of the frequency equation times exp(-a), zero at the wave number of a mode.
   pure real(wp) function frequency_function(c, epsilon) result(f)
      real(wp), intent(in) :: c
      real(wp), intent(in) :: epsilon
      real(wp) :: a, decay, ratio

      ratio = sqrt(1 + epsilon*c**2)
      a = c/ratio
      decay = exp(-a)
      f = 2*decay + (1 + decay**2)/2*cos(c)*(ratio**2 + 1/ratio**2) &
         - (1 - decay**2)/2*sin(c)*(ratio - 1/ratio)
   end function frequency_function

   !> Deflection at a height [-].
   pure real(wp) function deflection(mode, x) result(phi)
      type(cantilever_mode_t), intent(in) :: mode
      real(wp), intent(in) :: x
      !! height over the length [-]

      phi = mode%growing*exp(mode%a*(x - 1)) + mode%decaying*exp(-mode%a*x) &
         + mode%cosine*cos(mode%c*x) + mode%sine*sin(mode%c*x)
   end function deflection

   !> Slope of the deflection at a height, dphi/dx [-].
   pure real(wp) function slope_of(mode, x) result(slope)
      type(cantilever_mode_t), intent(in) :: mode
      real(wp), intent(in) :: x
      !! height over the length [-]

      slope = mode%a*(mode%growing*exp(mode%a*(x - 1)) - mode%decaying*exp(-mode%a*x)) &
         + mode%c*(mode%sine*cos(mode%c*x) - mode%cosine*sin(mode%c*x))
   end function slope_of

   !> Integral of phi from a height to the tip, the shear -psi'' over Lambda [-].
   pure real(wp) function force_above(mode, x) result(force)
      type(cantilever_mode_t), intent(in) :: mode
      real(wp), intent(in) :: x
      !! height over the length [-]

      force = (mode%decaying*exp(-mode%a*x) - mode%growing*exp(mode%a*(x - 1)))/mode%a &
         + (mode%sine*cos(mode%c*x) - mode%cosine*sin(mode%c*x))/mode%c
   end function force_above

   !> Integral of (s - x) phi(s) from a height x to the tip, the moment psi' over Lambda [-].
   pure real(wp) function moment_above(mode, x) result(moment)
      type(cantilever_mode_t), intent(in) :: mode
      real(wp), intent(in) :: x
      !! height over the length [-]

      moment = (mode%decaying*exp(-mode%a*x) + mode%growing*exp(mode%a*(x - 1)))/mode%a**2 &
         - (mode%cosine*cos(mode%c*x) + mode%sine*sin(mode%c*x))/mode%c**2
   end function moment_above

   !> Integral of phi**2 over the height, by Gauss's rule on each quarter wave.
   pure real(wp) function norm_of(mode, number) result(norm)
      type(cantilever_mode_t), intent(in) :: mode
      integer, intent(in) :: number
      integer, parameter :: n_nodes = 24
      real(wp) :: node, weight
      integer :: i, j

      norm = 0
      do j = 1, n_nodes
         call gauss_node(n_nodes, j, node, weight)
         do i = 1, 2*number
            norm = norm + weight/(4*number)*deflection(mode, (i - (1 - node)/2)/(2*number))**2
         end do
      end do
   end function norm_of

end module rwmf_math_cantilever
